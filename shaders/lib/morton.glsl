// Numbers of places along a Morton curve (Z order).

// Every other bit of a word; and the inverse.
uint spreadBits(uint x) {
  x = (x | x << 8u) & 0x00ff00ffu;
  x = (x | x << 4u) & 0x0f0f0f0fu;
  x = (x | x << 2u) & 0x33333333u;
  return (x | x << 1u) & 0x55555555u;
}
uint gatherBits(uint x) {
  x &= 0x55555555u;
  x = (x | x >> 1u) & 0x33333333u;
  x = (x | x >> 2u) & 0x0f0f0f0fu;
  x = (x | x >> 4u) & 0x00ff00ffu;
  return (x | x >> 8u) & 0x0000ffffu;
}
uint mortonOf(ivec2 place) { return spreadBits(uint(place.x)) | spreadBits(uint(place.y)) << 1u; }
