// An orthonormal frame about a unit vector [Duff2017].
void tangentFrame(vec3 n, out vec3 t, out vec3 b) {
  float s = n.z >= 0.0 ? 1.0 : -1.0;
  float p = -1.0 / (s + n.z), q = n.x * n.y * p;
  t = vec3(1.0 + s * n.x * n.x * p, s * q, -s * n.x);
  b = vec3(q, s + n.y * n.y * p, -n.y);
}
