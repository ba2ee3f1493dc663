// A virtual point light goes into one cell of every cascade that it lies in: gl_Layer chooses the slice, blending adds
// [ORIGINALS 1.3]. Its intensity is Phi / pi * max(0, cos), as SH Phi / pi * lobe(n). It is moved half a cell along its normal
// first, so that it does not light its own surface [GPU Pro 2, p. 190].
#include "lib/finite.glsl"
#include "lib/sh.glsl"
#include "lpv/common.glsl"
layout(points) in;
layout(points, max_vertices = LPV_MAX_CASCADES) out;
in vec4 gPosition[];
in vec4 gNormal[];
in vec4 gFlux[];
flat out vec4 fRed;
flat out vec4 fGreen;
flat out vec4 fBlue;

void main() {
  vec3 position = gPosition[0].xyz;
  vec3 normal = gNormal[0].xyz;
  vec3 flux = gFlux[0].rgb;
  // Background, black, zero and non-finite texels carry no light.
  bool usable = gPosition[0].w > 0.5 && allFinite(position) && allFinite(normal) && allFinite(flux) &&
                dot(normal, normal) > 0.25 && dot(normal, normal) < 4.0 && flux.r + flux.g + flux.b > 0.0;
  if (!usable) return;
  int cells = lpv.shape.x;
  for (int k = 0; k < lpv.shape.y; ++k) {
    float s = lpv.cascades[k].cellSize;
    vec3 cellPosition = (position + 0.5 * s * normal - lpv.cascades[k].minimum) / s;
    // Clamped before it becomes an integer: that of a huge number is undefined.
    ivec3 cell = ivec3(floor(clamp(cellPosition, -1.0, float(cells))));
    if (any(lessThan(cell, ivec3(0))) || any(greaterThanEqual(cell, ivec3(cells)))) continue;
    // Stored as c / (E_ref s^2): near 1 whatever the units, so 16-bit floats neither overflow nor fall into subnormals.
    vec4 lobe = shCosineLobe(normal) / (kPi * lpv.referenceIrradiance * s * s);
    fRed = flux.r * lobe;
    fGreen = flux.g * lobe;
    fBlue = flux.b * lobe;
    gl_Layer = k * cells + cell.z;
    gl_Position = vec4((vec2(cell.xy) + 0.5) / float(cells) * 2.0 - 1.0, 0.0, 1.0);
    gl_PointSize = 1.0;
    EmitVertex();
    EndPrimitive();
  }
}
