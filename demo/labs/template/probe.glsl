vec4 probe() {
#if PROBE == 1
  return vec4(discArea(point(0).x));
#elif PROBE == 2
  return vec4(discPoint(random2()), 0.0, 0.0);
#endif
}
