// A spot light's intensity relative to that on its axis, by the cosine of the angle to the axis. See SpotLight in
// scene/scene.hpp.
float spotFalloff(float cosine, float cosInner, float cosOuter) {
  float t = clamp((cosine - cosOuter) / max(cosInner - cosOuter, 1e-6), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}
