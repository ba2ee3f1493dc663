// The propagation kernel, and the units in which wavefronts and potentials are stored for it.
#if FACE_KERNEL
#include "lpv/kernel_faces.glsl"
const vec4 kStoredUnits = vec4(1.0);  // coefficients as stored
const vec4 kNextUnits = vec4(1.0);    // gathered by a step, as stored
const vec4 kSumUnits = vec4(1.0);     // gathered by a step, as coefficients
#else
#include "lpv/kernel.glsl"
const vec4 kStoredUnits = kFaceUnits;
const vec4 kNextUnits = kFluxInFaceUnits;
const vec4 kSumUnits = kFluxInCoefficients;
#endif
