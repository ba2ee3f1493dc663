// The sun's disc and lamps' balls, of the same radiance everywhere. Needs lib/tangent.glsl.

// A unit direction within a cone around the axis, uniform over its solid angle of 2 pi lessCosine. lessCosine: 1 -
// cosine of the half angle.
vec3 coneSample(vec3 axis, float lessCosine, vec2 xi) {
  float less = xi.x * lessCosine, sine = sqrt(less * (2.0 - less)), turn = 6.28318531 * xi.y;
  vec3 t, b;
  tangentFrame(axis, t, b);
  return (1.0 - less) * axis + sine * (cos(turn) * t + sin(turn) * b);
}

// 1 - cosine of the half angle of a ball, a hemisphere's from inside.
float ballLessCosine(float radius, float distance2) {
  float sine2 = min(radius * radius / distance2, 1.0);
  return sine2 / (1.0 + sqrt(1.0 - sine2));
}

// To the near side of a ball along a direction that meets it. toCentre: to its centre.
float distanceToBall(vec3 toCentre, float radius, vec3 direction) {
  float along = dot(toCentre, direction);
  vec3 beside = toCentre - along * direction;
  return max(along - sqrt(max(radius * radius - dot(beside, beside), 0.0)), 0.0);
}
