// Lab 5: cascades and their seams. Sample solution.

// TASK 1. Snap a grid's centre to the nearest whole number of cells, so that the grid does not swim while the camera
// moves.
vec3 snapped(vec3 centre, float cell) {
  return floor(centre / cell + 0.5) * cell;
}

// TASK 2. The finest cascade that contains p: cascade k is a cube about `centre` whose half side is halfExtent * 2^k;
// -1 if none does.
int cascadeOf(vec3 p, vec3 centre, float halfExtent, int count) {
  vec3 off = abs(p - centre);
  float largest = max(off.x, max(off.y, off.z));
  for (int k = 0; k < count; ++k)
    if (largest <= halfExtent * exp2(float(k))) return k;
  return -1;
}

// TASK 3. Weight of a cascade: 1 inside, falling to 0 at its border over the outer `band` of its half extent (band
// 0.2: the outer fifth).
float blendWeight(vec3 p, vec3 centre, float halfExtent, float band) {
  vec3 off = abs(p - centre) / halfExtent;
  return clamp((1.0 - max(off.x, max(off.y, off.z))) / band, 0.0, 1.0);
}

// TASK 4. Irradiance from two cascades that store flux per cell: each divided by its own cell's face area, then
// blended.
float blended(float fine, float fineCell, float coarse, float coarseCell, float weight) {
  return mix(coarse / (coarseCell * coarseCell), fine / (fineCell * fineCell), weight);
}

// TASK 5. Far end of slice i of a view from `near` to `far` divided into `count` slices: lambda times the logarithmic
// plus 1 - lambda times the uniform scheme.
float splitDistance(int i, int count, float near, float far, float lambda) {
  float t = float(i + 1) / float(count);
  return mix(near + (far - near) * t, near * pow(far / near, t), lambda);
}
