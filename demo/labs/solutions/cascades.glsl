// Lab 5: cascades and their seams. Sample solution.

// TASK 1. A grid's centre moved to the nearest whole number of cells, so that it does not swim while the camera
// moves.
vec3 snapped(vec3 centre, float cell) {
  return floor(centre / cell + 0.5) * cell;
}

// TASK 2. The finest cascade that holds p: cascade k is a cube about `centre` of half its side halfExtent * 2^k; -1
// where none does.
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

// TASK 4. Irradiance from two cascades that keep flux per cell: each over its own cell's face, then blended.
float blended(float fine, float fineCell, float coarse, float coarseCell, float weight) {
  return mix(coarse / (coarseCell * coarseCell), fine / (fineCell * fineCell), weight);
}

// TASK 5. Far end of slice i of a view from `near` to `far` cut into `count` slices: lambda of the logarithmic, 1 -
// lambda of the uniform scheme.
float splitDistance(int i, int count, float near, float far, float lambda) {
  float t = float(i + 1) / float(count);
  return mix(near + (far - near) * t, near * pow(far / near, t), lambda);
}
