// README.md describes the tasks; PI, frame() and random() are available. Remove NOT_DONE(n) when a task is done.

// TASK 1. The area of a disc.
float discArea(float radius) {
  NOT_DONE(1)
  return 0.0;
}

// TASK 2. A uniformly distributed point in a disc of radius 1; u: two independent numbers in [0,1).
vec2 discPoint(vec2 u) {
  NOT_DONE(2)
  return vec2(0.0);
}
