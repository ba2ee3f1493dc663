// Puts a virtual point light into one cell of every cascade that contains it: gl_Layer selects the slice, and blending
// adds [LPV2015, 6.4.2].
#include "lib/sh.glsl"
#include "cascades/block.glsl"
#include "lpv/vpl.glsl"
layout(points) in;
layout(points, max_vertices = MAX_CASCADES) out;
in vec4 gPosition[];
in vec4 gNormal[];
in vec4 gFlux[];
flat out vec4 fRed;
flat out vec4 fGreen;
flat out vec4 fBlue;

uniform float fluxScale;  // 1; without units, 1 / texel area of the light's map

void main() {
  vec3 normal = gNormal[0].xyz;
  vec3 flux = gFlux[0].rgb;
  if (!isUsableVpl(gPosition[0], normal, flux)) return;
  int cells = grids.shape.x;
  for (int k = 0; k < grids.shape.y; ++k) {
    ivec3 cell;
    if (!vplCell(k, gPosition[0].xyz, normal, cell)) continue;
    vec4 lobe = vplLobe(k, normal, fluxScale);
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
