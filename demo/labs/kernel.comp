// Runs one probe of a lab: the student's functions at points, for samples or for pixels. tasks.glsl comes first, so
// that it cannot access points or results.
layout(local_size_x = 64) in;
#include "lab/common.glsl"
#include "lab/tasks.glsl"

layout(std430, binding = 0) readonly buffer LabInputs { vec4 labInputs[]; };
layout(std430, binding = 1) writeonly buffer LabOutputs { vec4 labOutputs[]; };
uniform uint labCount, labStride, labWidth, labNoise;
uint labIndex = 0u;
// Vector k of this invocation's point; with a stride of zero all invocations share the inputs.
vec4 point(uint k) { return labInputs[labIndex * labStride + k]; }
// This invocation's pixel, row 0 at the top.
uvec2 pixel() { return uvec2(labIndex % labWidth, labIndex / labWidth); }
#include "lab/probe.glsl"

void main() {
  labIndex = gl_GlobalInvocationID.x;
  if (labIndex >= labCount) return;
  labRandomState = uvec3(labIndex, 0u, labNoise);
  labOutputs[labIndex] = probe();
}
