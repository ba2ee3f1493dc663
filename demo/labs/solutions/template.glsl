// TASK 1. The area of a disc.
float discArea(float radius) { return PI * radius * radius; }

// TASK 2. A uniformly distributed point in a disc of radius 1; u: two independent numbers in [0,1).
vec2 discPoint(vec2 u) {
  float angle = 2.0 * PI * u.y;
  return sqrt(u.x) * vec2(cos(angle), sin(angle));
}
