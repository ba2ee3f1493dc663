// Sends a triangle to several views of a layered target, one instance of the geometry shader per view. Triangles wholly
// outside one side of a view's frustum are dropped here: most triangles are visible in few of a cube's six views.
uniform mat4 clipFromPlace[LAYERS];  // of positions relative to viewPlace
uniform vec3 viewPlace[LAYERS];

vec4 clipOf(vec4 position, int layer) { return clipFromPlace[layer] * vec4(position.xyz - viewPlace[layer], 1.0); }

// Whether the triangle's plane contains the lamp that the view is from, within the rounding of positions. Such a
// surface does not shade the lamp: rays (rays/bvh.glsl) and shadow maps follow the same rule.
bool holdsLamp(vec3 a, vec3 b, vec3 c, int layer) {
  vec3 normal = cross(b - a, c - a), largest = max(max(abs(a), abs(b)), max(abs(c), abs(viewPlace[layer])));
  float gap = 9.5367431640625e-7 * max(largest.x, max(largest.y, largest.z));  // 2^-20
  return abs(dot(normal, a - viewPlace[layer])) <= gap * length(normal);
}

bool beyondOneSide(vec4 a, vec4 b, vec4 c) {
  vec3 x = vec3(a.x, b.x, c.x), y = vec3(a.y, b.y, c.y), z = vec3(a.z, b.z, c.z), w = vec3(a.w, b.w, c.w);
  return all(lessThanEqual(w, vec3(0.0))) || all(greaterThan(x, w)) || all(lessThan(x, -w)) || all(greaterThan(y, w)) ||
         all(lessThan(y, -w)) || all(greaterThan(z, w));
}
