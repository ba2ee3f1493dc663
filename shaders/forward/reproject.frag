// Adds a frame to the running mean of those before it (engine/forward/antialiasing.hpp).
// In motion each pixel's surface, the nearest of the pixel's neighbourhood so that edges move with what is before them,
// is looked for where the frame before showed it; an object that moves, by its own motion. The mean found there is
// limited to the new frame's own range around the pixel: mean and kDeviations standard deviations of 3x3 pixels
// [Salvi2016], within their extremes, beyond which the filter overshoots. Not that of path traced frames: nine noisy
// pixels do not know the range, and may all be black. All in linear radiance, as a camera adds up light: a mean of
// colours compressed by brightness is too dark at bright edges.
#include "lib/clamped_int.glsl"
layout(binding = 0) uniform sampler2D radianceTexture;
layout(binding = 1) uniform sampler2D depthTexture;
layout(binding = 2) uniform sampler2D beforeTexture;       // rgb; a: frames in it
layout(binding = 3) uniform sampler2D distanceBeforeTexture;
#if OBJECTS_MOVE
layout(binding = 4) uniform sampler2D objectMotion;  // engine/forward/object_motion.hpp
#endif
uniform mat4 beforeFromClip, beforeFromFar;  // from the frame's clip space; far: of what is infinitely far
uniform vec4 inverseDistance;                // times a place in clip space: 1 over its distance along the view
uniform vec2 offset;                         // of the frame's samples from pixels' centres, in pixels
uniform int moves, starts;                   // the view differs from the frame before; there is none before
uniform float frames;                        // in the frame itself: 1, or the mean of more
uniform float share;                         // of the frames before that still count
uniform float most, mostInMotion;
uniform int isPathTraced;
layout(location = 0) out vec4 mean;
layout(location = 1) out float nearestDistance;  // of 3x3 pixels

const float kDeviations = 1.25;
const float kSharpness = 0.75;  // 0.5 is Catmull-Rom: blurs more where a mean is read again in every frame
const float kSharpnessOfNoise = 0.5;  // more amplifies what differs from pixel to pixel
const float kInfinite = 1e30;
const float kFarther = 1.02;  // beyond this ratio of distances it is another surface

// Cubic convolution of 4x4 texels [Keys1981], by nine bilinear taps, of which the corners, with hardly any weight, are
// left out [Jimenez2016].
vec3 before(vec2 uv) { return textureLod(beforeTexture, uv, 0.0).rgb; }
vec3 cubic(vec2 uv, float sharpness) {
  vec2 size = vec2(textureSize(beforeTexture, 0)), place = uv * size, middle = floor(place - 0.5) + 0.5,
       f = place - middle, g = 1.0 - f;
  vec2 w0 = -sharpness * f * g * g, w3 = -sharpness * f * f * g, w12 = 1.0 - w0 - w3,
       w2 = 1.0 + g * g * ((2.0 - sharpness) * g - (3.0 - sharpness));
  vec2 at0 = (middle - 1.0) / size, at12 = (middle + w2 / w12) / size, at3 = (middle + 2.0) / size;
  vec3 sum = w12.x * w12.y * before(at12) + w12.x * w0.y * before(vec2(at12.x, at0.y)) +
             w0.x * w12.y * before(vec2(at0.x, at12.y)) + w3.x * w12.y * before(vec2(at3.x, at12.y)) +
             w12.x * w3.y * before(vec2(at12.x, at3.y));
  float weights = w12.x * w12.y + w12.x * (w0.y + w3.y) + w12.y * (w0.x + w3.x);
  return max(sum / weights, vec3(0.0));
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy), last = textureSize(radianceTexture, 0) - 1;
  vec3 radiance = texelFetch(radianceTexture, pixel, 0).rgb;
  vec2 size = vec2(last + 1);

  // The nearest surface around, and the range of distances and colours.
  vec4 nearest = vec4(0.0, 0.0, 1.0, 1.0);
  ivec2 nearestPixel = pixel;
  float inverseLeast = 0.0, inverseMost = kInfinite;
  vec3 sum = vec3(0.0), squares = vec3(0.0), least = vec3(kInfinite), largest = vec3(0.0);
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      ivec2 place = clamp(pixel + ivec2(x, y), ivec2(0), last);
      float depth = texelFetch(depthTexture, place, 0).r;
      vec4 clip = vec4(2.0 * (vec2(place) + 0.5) / size - 1.0, 2.0 * depth - 1.0, 1.0);
      float inverse = depth < 1.0 ? dot(inverseDistance, clip) : 0.0;
      if (inverse > inverseLeast) {
        inverseLeast = inverse;
        nearest = clip;
        nearestPixel = place;
      }
      inverseMost = min(inverseMost, inverse);
      vec3 c = texelFetch(radianceTexture, place, 0).rgb;
      sum += c;
      squares += c * c;
      least = min(least, c);
      largest = max(largest, c);
    }
  bool isFar = inverseLeast == 0.0;
  if (isFar) nearest.xy = 2.0 * gl_FragCoord.xy / size - 1.0;
  nearestDistance = isFar ? kInfinite : 1.0 / inverseLeast;
  mean = vec4(radiance, frames);
  if (starts != 0) return;
  if (moves == 0) {
    vec4 old = texelFetch(beforeTexture, pixel, 0);
    float count = min(share * old.a + frames, most);
    mean = vec4(mix(old.rgb, radiance, frames / count), count);
    return;
  }

  vec4 place = isFar ? beforeFromFar * nearest : beforeFromClip * nearest;
  vec2 uv = gl_FragCoord.xy / size + 0.5 * (place.xy / place.w - nearest.xy) - offset / size;
#if OBJECTS_MOVE
  vec4 motion = texelFetch(objectMotion, nearestPixel, 0);
  if (!isFar && motion.w > 0.0) {
    uv = gl_FragCoord.xy / size + 0.5 * motion.xy;
    place.w = motion.z;
  }
#endif
  if (!(place.w > 0.0) || any(lessThan(uv, vec2(0.0))) || any(greaterThan(uv, vec2(1.0)))) return;
  ivec2 pixelBefore = clampedInt(uv * size, ivec2(0), last);
  // Hidden before by something nearer, by more than the surface itself varies around the pixel?
  float distance = isFar ? kInfinite : place.w / inverseLeast,
        spread = isFar || inverseMost == 0.0 ? 0.0 : 1.0 / inverseMost - nearestDistance;
  if (distance > kFarther * texelFetch(distanceBeforeTexture, pixelBefore, 0).r + spread) return;
  vec3 old = cubic(uv, isPathTraced != 0 ? kSharpnessOfNoise : kSharpness);
  if (isPathTraced == 0) {
    vec3 middle = sum / 9.0, range = kDeviations * sqrt(max(squares / 9.0 - middle * middle, vec3(0.0)));
    vec3 away = old - middle, ratios = abs(away) / max(range, vec3(1e-30));
    old = clamp(middle + away / max(1.0, max(ratios.r, max(ratios.g, ratios.b))), least, largest);
  }
  float count = min(texelFetch(beforeTexture, pixelBefore, 0).a + frames, mostInMotion);
  mean = vec4(mix(old, radiance, frames / count), count);
}
