// Lab 6: hemicubes. README.md describes the tasks; PI, frame() and random() are available.
// Remove NOT_DONE(n) when a task is done.

// TASK 1. Form factor of a small area at p on the hemicube's top (the square from -1 to 1 at height 1 above the patch).
float deltaTop(vec2 p, float area) {
  NOT_DONE(1)
  return 0.0;
}

// TASK 2. The same on a side: y along it from -1 to 1, z above the patch from 0 to 1.
float deltaSide(float y, float z, float area) {
  NOT_DONE(2)
  return 0.0;
}

// TASK 3. The unit direction through the centre of a pixel. n: pixels per side of the cube; face: 0 top, 1 +x, 2 -x, 3
// +y, 4 -y; z is the normal.
vec3 pixelDirection(int face, ivec2 pixel, int n) {
  NOT_DONE(3)
  return vec3(0.0, 0.0, 1.0);
}

// TASK 4. One Jacobi sweep over three patches: the radiosity of each from that of all; F[3 * i + j] is the form factor
// from i to j.
vec3 sweep(vec3 radiosity, vec3 emission, vec3 reflectance, float F[9]) {
  NOT_DONE(4)
  return vec3(0.0);
}

// TASK 5. Upper bound of the radiosity's distance from the solution after a sweep whose largest change was `change`;
// `reflectance` is the largest of all patches.
float errorBound(float change, float reflectance) {
  NOT_DONE(5)
  return 0.0;
}
