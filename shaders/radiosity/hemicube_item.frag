// Item buffer: writes the patch number + 1, and a depth with the same relative precision near and far.
flat in uint fItem;
flat in float fBias;
in float fDistance;
uniform float inverseFar;
layout(location = 0) out uint item;

void main() {
  item = fItem;
  gl_FragDepth = fDistance * inverseFar * fBias;
}
