// Where a surface is drawn. Of a lamp and a ceiling in one plane the lamp is seen, as rays see it (rays/bvh.glsl), so
// what emits is drawn a little nearer: by more than the rounding of places, and by a few steps of a float's depth.
// EMITTERS: something does. Needs lib/frame.glsl.
#if EMITTERS
uniform vec3 materialEmission;
#endif

vec4 drawnAt(vec3 position) {
  vec4 clip = frame.clipFromWorld * vec4(position, 1.0);
#if EMITTERS
  const float kNearer = 5e-5, kSteps = 5.0 * 5.9604645e-8;
  if (materialEmission != vec3(0.0)) {
    // Part of the way to the eye, whose w is 0 in a perspective view: the place in the picture does not change.
    float eye = (frame.clipFromWorld * vec4(eyeOf(position), 1.0)).z;
    clip.z += kNearer * (isOrthographic() ? eye - clip.z : eye) - kSteps * clip.w;
  }
#endif
  return clip;
}
