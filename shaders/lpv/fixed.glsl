// Scale of the fixed-point counters. Coefficients are stored as c / (E_ref s^2), so the same light gives smaller values
// in a coarser cascade; it gets proportionally more steps per unit. Needs cascades/block.glsl.
float stepsOfCascade(int k, float fixedScale) {
#if FLUX_UNITS
  return fixedScale;  // deviation lpv.flux-units: cells of all sizes use the same scale
#else
  float ratio = grids.cascades[k].cellSize / grids.cascades[0].cellSize;
  return fixedScale * ratio * ratio;
#endif
}
