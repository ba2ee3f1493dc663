// How far a point is inside a cascade: 1 well inside, 0 where the cascade has faded out. Needs lpv/common.glsl.
float lpvCascadeWeight(int k, vec3 position) {
  vec3 away = abs(position - lpv.cascades[k].blendCentre);
  float rest = lpv.cascades[k].blendHalf - max(away.x, max(away.y, away.z));
  return clamp(rest / (lpv.blendBand * lpv.cascades[k].blendHalf), 0.0, 1.0);
}
