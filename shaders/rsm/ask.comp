// Lists what the gather found for one pixel: one entry per sample of the pattern and gather point, with the
// interpolation weights. One invocation; flag ASKED.
layout(local_size_x = 1) in;
#include "rsm/gather.glsl"
#include "rsm/fit.glsl"
#include "forward/asked_parts.glsl"
layout(binding = 5) uniform sampler2D gathered;  // w: 2 if interpolation rejected the pixel
uniform ivec2 askedPixel;
uniform int interpolates;

float share = 1.0;  // weight of the gather point

void tell(int i, RsmSurfel surfel, ivec3 texel, vec3 irradiance) {
  if (irradiance == vec3(0.0)) return;
  tellPart(AskedPart(share * irradiance, share, surfel.position, 0.0, ivec4(texel, 0), vec4(0.0), vec4(0.0),
                     vec4(0.0)));
}

void gatherAt(ivec2 pixel) {
  gatherIrradiance(visiblePosition(pixel), visibleUnitNormal(pixel), pixelRotation(pixel));
}

void main() {
  bool refused = texelFetch(gathered, askedPixel, 0).w > 1.5;
  if (interpolates == 0 || refused) {
    gatherAt(askedPixel);
  } else {
    float weights = 0.0;
    for (int i = 0; i < 4; ++i) {
      LowSample near = lowSample(askedPixel, i);
      if (near.fits) weights += near.weight;
    }
    for (int i = 0; i < 4; ++i) {
      LowSample near = lowSample(askedPixel, i);
      share = near.weight / weights;
      if (near.fits && share > 0.0) gatherAt(near.pixel);
    }
  }
  endParts();
}
