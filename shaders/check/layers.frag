// A value for each texel and layer, added by blending: small integers, exact in 32-bit floats.
flat in int layer;
out vec4 color;

void main() {
  color = vec4(1.0, float(layer), gl_FragCoord.x - 0.5, gl_FragCoord.y - 0.5);
}
