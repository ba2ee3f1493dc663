// Item buffer: a patch's number + 1, at a depth in which floats are equally exact near and far.
flat in uint fItem;
flat in float fBias;
in float fDistance;
uniform float inverseFar;
layout(location = 0) out uint item;

void main() {
  item = fItem;
  gl_FragDepth = fDistance * inverseFar * fBias;
}
