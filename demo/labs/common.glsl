// Functions available to labs in addition to GLSL's own.
const float PI = 3.14159265358979;

// Marks a task as not done; remove the line when it is.
#define NOT_DONE(task)

// Independent random numbers in [0,1): pcg3d [Jarzynski2020] of invocation, draw and run.
uvec3 labRandomState = uvec3(0u);
float random() {
  uvec3 v = labRandomState * 1664525u + 1013904223u;
  labRandomState.y += 1u;
  v.x += v.y * v.z; v.y += v.z * v.x; v.z += v.x * v.y;
  v ^= v >> 16u;
  v.x += v.y * v.z;
  return float(v.x >> 8u) * 5.9604644775390625e-8;
}
vec2 random2() { float x = random(); return vec2(x, random()); }

// Two unit vectors perpendicular to a unit vector and to each other [Duff2017].
void frame(vec3 n, out vec3 t, out vec3 b) {
  float s = n.z >= 0.0 ? 1.0 : -1.0;
  float p = -1.0 / (s + n.z), q = n.x * n.y * p;
  t = vec3(1.0 + s * n.x * n.x * p, s * q, -s * n.x);
  b = vec3(q, s + n.y * n.y * p, -n.y);
}
