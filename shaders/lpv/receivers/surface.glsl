// A receiver's surface, on the side that the receiver is on. Needs rays/materials.glsl and receivers/common.glsl.
Surface surfaceOf(LpvReceiver receiver) {
  vec3 normal = normalOf(receiver.triangle);
  return surfaceAt(receiver.triangle, vec2(receiver.second, receiver.third),
                   (receiver.state & LPV_FRONT) != 0u ? -normal : normal);
}
