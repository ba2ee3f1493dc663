// The receivers beside one: in the cells around its own, of its cascade and face.
// Needs lpv/receivers/common.glsl.
layout(binding = 7) uniform usamplerBuffer lpvSlots;
const int kNeighbours = 26;

// i: 0 to kNeighbours - 1. false: that cell has none.
bool neighbourAt(ivec4 ofReceiver, int i, out uint receiver) {
  int place = i < kNeighbours / 2 ? i : i + 1, cascade = ofReceiver.w / LPV_FACES;  // the middle of 27 is itself
  ivec3 cell = ofReceiver.xyz + ivec3(place % 3, place / 3 % 3, place / 9) - 1,
        inGrid = cell - receiving.firstCell[cascade].xyz;
  receiver = 0u;
  if (any(lessThan(inGrid, ivec3(0))) || any(greaterThanEqual(inGrid, ivec3(lpv.shape.x)))) return false;
  uint holds = texelFetch(lpvSlots, slotOf(cascade, ofReceiver.w % LPV_FACES, cell)).x;
  receiver = holds - 1u;
  return holds != 0u && holds <= receiving.capacity;
}
