// Lab 4: light propagation volumes. README.md describes the tasks; PI, frame() and random() are available.
// Remove NOT_DONE(n) when a task is done.

// Given, from lab 3: basis and clamped cosine in bands 0 and 1; solid angles of a cell's faces as seen from the
// centre of the cell behind, in sr.
vec4 shBasis(vec3 w) { return vec4(0.28209479, 0.48860251 * w); }
vec4 cosineLobe(vec3 n) { return vec4(0.88622693, 1.02332671 * n); }
const float kFrontSolidAngle = 0.40066968464623916;
const float kSideSolidAngle = 0.42343135443673924;

// TASK 1. The cell into which a virtual point light on a surface is injected; `minimum` is the grid's corner, `cell`
// the size of a cell.
ivec3 injectionCell(vec3 position, vec3 normal, vec3 minimum, float cell) {
  NOT_DONE(1)
  return ivec3(0);
}

// TASK 2. The coefficients of the intensity of a light with that flux on a Lambertian surface.
vec4 injectedLight(vec3 normal, float flux) {
  NOT_DONE(2)
  return vec4(0.0);
}

// TASK 3. The flux that an intensity with coefficients c sends into a solid angle about a unit direction; never
// negative.
float fluxInto(vec4 c, vec3 towards, float solidAngle) {
  NOT_DONE(3)
  return 0.0;
}

// TASK 4. The light that a cell receives from the neighbour behind it. Light travels along `travel`; u and v are
// perpendicular to it.
vec4 propagated(vec4 source, vec3 travel, vec3 u, vec3 v) {
  NOT_DONE(4)
  return vec4(0.0);
}

// TASK 5. Irradiance at a surface with normal n: the flux that tasks 3 and 4 send through a cell face parallel to the
// surface, divided by the face's area.
float irradianceAt(vec4 c, vec3 n, float cell) {
  NOT_DONE(5)
  return 0.0;
}
