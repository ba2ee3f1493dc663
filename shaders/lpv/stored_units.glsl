// The kernel of a propagation step, and the units in which fronts and potentials are stored for it.
#if FACE_KERNEL
#include "lpv/kernel_faces.glsl"
const vec4 kStoredUnits = vec4(1.0);  // coefficients as stored
const vec4 kNextUnits = vec4(1.0);    // what a step gathers, as stored
const vec4 kSumUnits = vec4(1.0);     // what a step gathers, as coefficients
#else
#include "lpv/kernel.glsl"
const vec4 kStoredUnits = kFaceUnits;
const vec4 kNextUnits = kFluxInFaceUnits;
const vec4 kSumUnits = kFluxInCoefficients;
#endif
