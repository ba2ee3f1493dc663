// Lab 5: cascades and their seams. README.md tells what is asked; PI, frame() and random() are there.
// Take NOT_DONE(n) out when a task is done.

// TASK 1. A grid's centre moved to the nearest whole number of cells, so that it does not swim while the camera
// moves.
vec3 snapped(vec3 centre, float cell) {
  NOT_DONE(1)
  return vec3(0.0);
}

// TASK 2. The finest cascade that holds p: cascade k is a cube about `centre` of half its side halfExtent * 2^k; -1
// where none does.
int cascadeOf(vec3 p, vec3 centre, float halfExtent, int count) {
  NOT_DONE(2)
  return -1;
}

// TASK 3. Weight of a cascade: 1 inside, falling to 0 at its border over the outer `band` of its half extent (band
// 0.2: the outer fifth).
float blendWeight(vec3 p, vec3 centre, float halfExtent, float band) {
  NOT_DONE(3)
  return 0.0;
}

// TASK 4. Irradiance from two cascades that keep flux per cell: each over its own cell's face, then blended.
float blended(float fine, float fineCell, float coarse, float coarseCell, float weight) {
  NOT_DONE(4)
  return 0.0;
}

// TASK 5. Far end of slice i of a view from `near` to `far` cut into `count` slices: lambda of the logarithmic, 1 -
// lambda of the uniform scheme.
float splitDistance(int i, int count, float near, float far, float lambda) {
  NOT_DONE(5)
  return 0.0;
}
