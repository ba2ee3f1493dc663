// Lab 6: hemicubes. Sample solution.

// TASK 1. Form factor of a small area at p on the hemicube's top (the square from -1 to 1 at height 1 above the patch).
float deltaTop(vec2 p, float area) {
  float square = dot(p, p) + 1.0;
  return area / (PI * square * square);
}

// TASK 2. The same on a side: y along it from -1 to 1, z above the patch from 0 to 1.
float deltaSide(float y, float z, float area) {
  float square = y * y + z * z + 1.0;
  return z * area / (PI * square * square);
}

// TASK 3. The unit direction through the centre of a pixel. n: pixels per side of the cube; face: 0 top, 1 +x, 2 -x, 3
// +y, 4 -y; z is the normal.
vec3 pixelDirection(int face, ivec2 pixel, int n) {
  vec2 p = 2.0 * (vec2(pixel) + 0.5) / float(n);
  vec3 d = face == 0 ? vec3(p - 1.0, 1.0) :
           face == 1 ? vec3(1.0, p.x - 1.0, p.y) : face == 2 ? vec3(-1.0, p.x - 1.0, p.y) :
           face == 3 ? vec3(p.x - 1.0, 1.0, p.y) : vec3(p.x - 1.0, -1.0, p.y);
  return normalize(d);
}

// TASK 4. One Jacobi sweep over three patches: the radiosity of each from that of all; F[3 * i + j] is the form factor
// from i to j.
vec3 sweep(vec3 radiosity, vec3 emission, vec3 reflectance, float F[9]) {
  vec3 result;
  for (int i = 0; i < 3; ++i)
    result[i] = emission[i] + reflectance[i] *
        (F[3 * i] * radiosity[0] + F[3 * i + 1] * radiosity[1] + F[3 * i + 2] * radiosity[2]);
  return result;
}

// TASK 5. Upper bound of the radiosity's distance from the solution after a sweep whose largest change was `change`;
// `reflectance` is the largest of all patches.
float errorBound(float change, float reflectance) {
  return change * reflectance / (1.0 - reflectance);
}
