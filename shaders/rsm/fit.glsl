// Which of the low-resolution samples around a pixel can represent it [Dachsbacher2005]: a similar normal, near its
// tangent plane, not far away.
#include "lib/clamped_int.glsl"
#include "lib/frame.glsl"
#include "forward/visible.glsl"
#include "rsm/low.glsl"
// Width of a pixel, scene units across the view: per unit of distance, or at any distance of an orthographic view.
uniform float pixelWidth;
uniform float fitNormal;    // minimum cosine between the normals
// maximum distance from the tangent plane, in low-resolution sample spacings at the pixel
uniform float fitPlane;
uniform float fitDistance;  // maximum distance, in the same unit

struct LowSample {
  ivec2 low;     // index of the low-resolution sample
  ivec2 pixel;   // its pixel
  bool fits;
  float weight;  // bilinear
};

// The i-th of the four around the pixel.
LowSample lowSample(ivec2 pixel, int i) {
  vec3 position = visiblePosition(pixel), normal = visibleUnitNormal(pixel);
  float stepLength =
      float(lowStep) * pixelWidth * (isOrthographic() ? 1.0 : distance(position, frame.cameraPosition));
  ivec2 lowSize = (textureSize(visibleDepth, 0) + lowStep - 1) / lowStep;
  vec2 at = (vec2(pixel) - float(lowStep / 2)) / float(lowStep);
  ivec2 base = clampedInt(floor(at), ivec2(0), max(lowSize - 2, 0));
  vec2 f = clamp(at - vec2(base), 0.0, 1.0);
  ivec2 corner = ivec2(i & 1, i >> 1);
  LowSample result;
  result.low = min(base + corner, lowSize - 1);
  result.pixel = lowPixel(result.low);
  vec2 weight = mix(1.0 - f, f, vec2(corner));
  result.weight = weight.x * weight.y;
  result.fits = false;
  if (!isVisibleSurface(result.pixel)) return result;
  vec3 away = visiblePosition(result.pixel) - position, otherNormal = visibleUnitNormal(result.pixel);
  result.fits = !(dot(normal, otherNormal) < fitNormal || length(away) > fitDistance * stepLength ||
                  max(abs(dot(normal, away)), abs(dot(otherNormal, away))) > fitPlane * stepLength);
  return result;
}
