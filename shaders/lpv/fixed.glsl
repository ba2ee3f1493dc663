// Steps of the fixed-point counts. A coefficient is stored as c / (E_ref s^2), so the same light counts less in a
// coarser cascade: it gets as many more steps a unit. Needs lpv/common.glsl.
float stepsOfCascade(int k, float fixedScale) {
#if FLUX_UNITS
  return fixedScale;  // deviation lpv.flux-units: cells of all sizes count the same
#else
  float ratio = lpv.cascades[k].cellSize / lpv.cascades[0].cellSize;
  return fixedScale * ratio * ratio;
#endif
}
