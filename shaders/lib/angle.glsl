// The angle in [0, pi] whose sine, at least 0, and cosine are these, both times any length above 0; to 3e-7 of itself.
// OpenGL leaves open how exact atan is, and NVIDIA's puts form factors off by 5e-4. arctan below pi/8 by an odd
// polynomial (least relative error, 2e-8); above by arctan x = pi/4 + arctan((x - 1) / (x + 1)).
float angleOf(float sine, float cosine) {
  float across = abs(cosine), least = min(sine, across), most = max(sine, across);
  bool wide = least > 0.41421356 * most;
  float x = (wide ? least - most : least) / (wide ? least + most : most), z = x * x;
  float angle = x + x * z * (-0.3333295 + z * (0.1997771 + z * (-0.1387768 + z * 0.08053721)));
  angle += wide ? 0.785398163 : 0.0;
  angle = sine > across ? 1.57079633 - angle : angle;
  return cosine < 0.0 ? 3.14159265 - angle : angle;
}
