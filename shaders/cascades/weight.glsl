// How far a point is inside a cascade: 1 well inside, 0 where the cascade has faded out. Needs cascades/block.glsl.
float cascadeWeight(int k, vec3 position) {
  vec3 away = abs(position - grids.cascades[k].blendCentre);
  float rest = grids.cascades[k].blendHalf - max(away.x, max(away.y, away.z));
  return clamp(rest / (grids.blendBand * grids.cascades[k].blendHalf), 0.0, 1.0);
}
