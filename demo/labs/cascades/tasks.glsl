// Lab 5: cascades and their seams. README.md describes the tasks; PI, frame() and random() are available.
// Remove NOT_DONE(n) when a task is done.

// TASK 1. Snap a grid's centre to the nearest whole number of cells, so that the grid does not swim while the camera
// moves.
vec3 snapped(vec3 centre, float cell) {
  NOT_DONE(1)
  return vec3(0.0);
}

// TASK 2. The finest cascade that contains p: cascade k is a cube about `centre` whose half side is halfExtent * 2^k;
// -1 if none does.
int cascadeOf(vec3 p, vec3 centre, float halfExtent, int count) {
  NOT_DONE(2)
  return -1;
}

// TASK 3. Weight of a cascade: 1 inside, falling to 0 at its border over the outer `band` of its half extent (band 0.2:
// the outer fifth).
float blendWeight(vec3 p, vec3 centre, float halfExtent, float band) {
  NOT_DONE(3)
  return 0.0;
}

// TASK 4. Irradiance from two cascades that store flux per cell: each divided by its own cell's face area, then
// blended.
float blended(float fine, float fineCell, float coarse, float coarseCell, float weight) {
  NOT_DONE(4)
  return 0.0;
}

// TASK 5. Far end of slice i of a view from `near` to `far` divided into `count` slices: lambda times the logarithmic
// plus 1 - lambda times the uniform scheme.
float splitDistance(int i, int count, float near, float far, float lambda) {
  NOT_DONE(5)
  return 0.0;
}
