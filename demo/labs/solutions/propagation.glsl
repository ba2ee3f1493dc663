// Lab 4: light propagation volumes. Sample solution.

// Given, from lab 3: basis and clamped cosine in bands 0 and 1; solid angles of a cell's faces as seen from the
// centre of the cell behind, in sr.
vec4 shBasis(vec3 w) { return vec4(0.28209479, 0.48860251 * w); }
vec4 cosineLobe(vec3 n) { return vec4(0.88622693, 1.02332671 * n); }
const float kFrontSolidAngle = 0.40066968464623916;
const float kSideSolidAngle = 0.42343135443673924;

// TASK 1. The cell into which a virtual point light on a surface is injected; `minimum` is the grid's corner, `cell`
// the size of a cell.
ivec3 injectionCell(vec3 position, vec3 normal, vec3 minimum, float cell) {
  return ivec3(floor((position + 0.5 * cell * normal - minimum) / cell));
}

// TASK 2. The coefficients of the intensity of a light with that flux on a Lambertian surface.
vec4 injectedLight(vec3 normal, float flux) {
  return cosineLobe(normal) * (flux / PI);
}

// TASK 3. The flux that an intensity with coefficients c sends into a solid angle about a unit direction; never
// negative.
float fluxInto(vec4 c, vec3 towards, float solidAngle) {
  return max(0.0, dot(c, shBasis(towards))) * solidAngle;
}

// TASK 4. The light that a cell receives from the neighbour behind it. Light travels along `travel`; u and v are
// perpendicular to it.
vec4 propagated(vec4 source, vec3 travel, vec3 u, vec3 v) {
  vec4 sum = injectedLight(travel, fluxInto(source, travel, kFrontSolidAngle));
  vec3 sides[4] = vec3[4](u, -u, v, -v);
  for (int k = 0; k < 4; ++k)
    sum += injectedLight(sides[k], fluxInto(source, (2.0 * travel + sides[k]) / sqrt(5.0), kSideSolidAngle));
  return sum;
}

// TASK 5. Irradiance at a surface with normal n: the flux that tasks 3 and 4 send through a cell face parallel to the
// surface, divided by the face's area.
float irradianceAt(vec4 c, vec3 n, float cell) {
  vec3 u, v;
  frame(-n, u, v);
  float flux = fluxInto(c, -n, kFrontSolidAngle);
  vec3 sides[4] = vec3[4](u, -u, v, -v);
  for (int k = 0; k < 4; ++k) flux += fluxInto(c, (-2.0 * n + sides[k]) / sqrt(5.0), kSideSolidAngle);
  return flux / (cell * cell);
}
