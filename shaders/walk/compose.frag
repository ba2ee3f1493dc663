// The window's picture: one or two pictures of a view, each whole, or divided by a wipe or side by side, with a common
// exposure, tone map and zoom. Each is shown as it is or as its difference from a reference. A magnifier follows the
// cursor.
// Curve and encoding: shaders/forward/tonemap.frag.
#include "lib/clamped_int.glsl"
#include "lib/tonemap.glsl"
layout(binding = 0) uniform sampler2D leftPicture;    // linear radiance
layout(binding = 1) uniform sampler2D rightPicture;
layout(binding = 2) uniform sampler2D reference;      // mean, as many texels as the pictures
layout(binding = 3) uniform sampler2D standardError;  // of the mean
layout(binding = 4) uniform sampler2D leftFlip;       // FLIP's map, 0..1
layout(binding = 5) uniform sampler2D rightFlip;
uniform ivec2 views;       // of left and right: SHOW_* values
uniform vec2 pixels;       // of the target
uniform float split;       // fraction of the width where the right picture begins; 1: only the left one
uniform bool sideBySide;
uniform float zoom;        // 1: the picture fits
uniform vec2 centre;       // point of the picture, 0..1, shown in the middle of the target
uniform bool interpolates;  // between texels, as they are shown: of a picture that is coarser for a while
uniform float exposure;
uniform float errorScale;  // radiance at the end of the signed colours
uniform vec4 magnifier;    // centre in pixels of the target, radius in pixels (0: none), factor
uniform vec4 bars[2];      // colour scales of left and right: lower corner and size in pixels of the target (0: none)
layout(location = 0) out vec4 displayColor;

const int SHOW_PICTURE = 0, SHOW_SIGNED = 1, SHOW_RELATIVE = 2, SHOW_Z = 3, SHOW_FLIP = 4, SHOW_VALUES = 5;

float luminance(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }  // IEC 61966-2-1

// Blue (-1) through white (0) to red (+1).
vec3 diverging(float t) {
  return t < 0.0 ? vec3(1.0 + max(t, -1.0), 1.0 + max(t, -1.0), 1.0) : vec3(1.0, 1.0 - min(t, 1.0), 1.0 - min(t, 1.0));
}
// Black (0) through red and yellow to white (1).
vec3 heat(float t) { return clamp(vec3(3.0 * t, 3.0 * t - 1.0, 3.0 * t - 2.0), 0.0, 1.0); }

// In standard errors of the reference; grey where noise explains the difference. A pixel's channels are assumed to rise
// and fall together.
const float MOST_Z = 20.0;
vec3 zColor(float z) {
  return abs(z) < 3.0 ? vec3(0.35) : diverging(sign(z) * clamp(abs(z) / MOST_Z, 0.15, 1.0));
}

// The colour scale of a view at 0..1 of its length.
vec3 scaleColor(int view, float t) {
  if (view == SHOW_SIGNED) return diverging(2.0 * t - 1.0);
  return view == SHOW_Z ? zColor(MOST_Z * (2.0 * t - 1.0)) : heat(t);
}

vec3 shownAt(bool right, ivec2 texel) {
  texel = clamp(texel, ivec2(0), (right ? textureSize(rightPicture, 0) : textureSize(leftPicture, 0)) - 1);
  vec3 radiance = right ? texelFetch(rightPicture, texel, 0).rgb : texelFetch(leftPicture, texel, 0).rgb;
  int view = right ? views.y : views.x;
  if (any(isnan(radiance)) || any(isinf(radiance))) return vec3(0.0, 1.0, 0.0);
  if (view == SHOW_PICTURE) return srgbFromLinear(filmic(exposure * radiance));
  if (view == SHOW_VALUES) return clamp(radiance, 0.0, 1.0);
  if (view == SHOW_FLIP) return heat((right ? texelFetch(rightFlip, texel, 0) : texelFetch(leftFlip, texel, 0)).r);
  vec3 reference = texelFetch(reference, texel, 0).rgb;
  vec3 noise = texelFetch(standardError, texel, 0).rgb;
  float difference = luminance(radiance - reference);
  if (view == SHOW_SIGNED) return diverging(difference / errorScale);
  if (view == SHOW_RELATIVE) {
    vec3 d = abs(radiance - reference);
    return heat(max(d.x, max(d.y, d.z)) / max(max(reference.x, max(reference.y, reference.z)), 1e-30));
  }
  return zColor(difference / max(luminance(noise), 1e-30));
}

vec3 shown(bool right, vec2 place) {
  const int kMost = 1 << 24;
  if (!interpolates) return shownAt(right, clampedInt(floor(place), ivec2(-1), ivec2(kMost)));
  vec2 corner = floor(place - 0.5), share = place - 0.5 - corner;
  ivec2 texel = clampedInt(corner, ivec2(-1), ivec2(kMost));
  return mix(mix(shownAt(right, texel), shownAt(right, texel + ivec2(1, 0)), share.x),
             mix(shownAt(right, texel + ivec2(0, 1)), shownAt(right, texel + ivec2(1, 1)), share.x), share.y);
}

void main() {
  vec2 pixel = gl_FragCoord.xy;
  for (int i = 0; i < 2; ++i) {
    vec2 inBar = (pixel - bars[i].xy) / max(bars[i].zw, vec2(1e-6));
    if (bars[i].z <= 0.0 || any(lessThan(inBar, vec2(0.0))) || any(greaterThan(inBar, vec2(1.0)))) continue;
    displayColor = vec4(scaleColor(i == 0 ? views.x : views.y, inBar.x), 1.0);
    return;
  }
  float magnified = zoom;
  if (magnifier.z > 0.0) {
    vec2 offset = pixel - magnifier.xy;
    float beyond = max(abs(offset.x), abs(offset.y)) - magnifier.z;
    if (beyond > 0.0 && beyond < 2.0) {
      displayColor = vec4(1.0, 0.8, 0.2, 1.0);
      return;
    }
    if (beyond <= 0.0) pixel = magnifier.xy + offset / magnifier.w, magnified *= magnifier.w;
  }
  float edge = sideBySide ? 0.5 : split;
  bool right = pixel.x >= edge * pixels.x;
  if (edge > 0.0 && edge < 1.0 && abs(pixel.x - edge * pixels.x) < 0.75 && magnified == zoom) {
    displayColor = vec4(1.0);
    return;
  }
  vec2 region = sideBySide ? vec2(0.5 * pixels.x, pixels.y) : pixels;
  vec2 middle = sideBySide ? vec2(right ? 0.75 : 0.25, 0.5) * pixels : 0.5 * pixels;
  vec2 size = vec2(right ? textureSize(rightPicture, 0) : textureSize(leftPicture, 0));
  vec2 filled = region / size;
  float fit = min(filled.x, filled.y);
  // The proportions of a coarse picture are up to a texel off, which no bar is to show.
  vec2 pixelsOfTexel = zoom * (interpolates && all(lessThan(filled, vec2(1.02 * fit))) ? filled : vec2(fit));
  vec2 place = (pixel - middle) / pixelsOfTexel + centre * size;  // in texels
  if (any(lessThan(place, vec2(0.0))) || any(greaterThanEqual(place, size))) {
    displayColor = vec4(0.08, 0.08, 0.08, 1.0);
    return;
  }
  vec2 side = 1.0 / (pixelsOfTexel * magnified / zoom);  // of a pixel, in texels
  int taps = clampedInt(ceil(max(side.x, side.y) - 0.01), 1, 4);
  vec3 sum = vec3(0.0);
  for (int y = 0; y < 4 && y < taps; ++y)
    for (int x = 0; x < 4 && x < taps; ++x)
      sum += shown(right, place + side * ((vec2(x, y) + 0.5) / float(taps) - 0.5));
  displayColor = vec4(sum / float(taps * taps), 1.0);
}
