// Lists what the gather found for one pixel: one entry per sample of the pattern and gather point, with the
// interpolation weights. One invocation; flag INSPECTED.
layout(local_size_x = 1) in;
#include "rsm/gather.glsl"
#include "rsm/fit.glsl"
#include "forward/inspected_parts.glsl"
layout(binding = 5) uniform sampler2D gathered;  // w: 2 if interpolation rejected the pixel
uniform ivec2 inspectedPixel;
uniform int interpolates;

float share = 1.0;  // weight of the gather point

void tell(int i, RsmSurfel surfel, ivec3 texel, vec3 irradiance) {
  if (irradiance == vec3(0.0)) return;
  tellPart(InspectedPart(share * irradiance, share, surfel.position, 0.0, ivec4(texel, 0), vec4(0.0), vec4(0.0),
                     vec4(0.0)));
}

void gatherAt(ivec2 pixel) {
  gatherIrradiance(visiblePosition(pixel), visibleUnitNormal(pixel), pixelRotation(pixel));
}

void main() {
  bool refused = texelFetch(gathered, inspectedPixel, 0).w > 1.5;
  if (interpolates == 0 || refused) {
    gatherAt(inspectedPixel);
  } else {
    float weights = 0.0;
    for (int i = 0; i < 4; ++i) {
      LowSample near = lowSample(inspectedPixel, i);
      if (near.fits) weights += near.weight;
    }
    for (int i = 0; i < 4; ++i) {
      LowSample near = lowSample(inspectedPixel, i);
      share = near.weight / weights;
      if (near.fits && share > 0.0) gatherAt(near.pixel);
    }
  }
  endParts();
}
