// Averages what rough coats reflect over the pixels beside, along one axis; it runs along both, after reflect.comp. The
// lobe of a rough coat is many pixels wide, and the few rays of one pixel that meet a bright window, the sky or a flame
// are white specks. Only pixels of the same coat on the same surface count, as far as their normals turn the lobe by
// less than its width. Mirrors, glass and narrow lobes stay as they are.
layout(local_size_x = 8, local_size_y = 8) in;
#include "lib/clamped_int.glsl"
#include "forward/visible.glsl"
layout(binding = UNIT_REFLECTED) uniform sampler2D reflections;  // alpha: of a coat's lobe; <= 0: not averaged
layout(rgba32f, binding = 0) writeonly restrict uniform image2D smoothed;
uniform ivec2 along;

const int kMostPixels = 4;  // to each side
const float kPixelsOfAlpha = 40.0, kSameAlpha = 0.1, kSamePlane = 0.2;

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), size = textureSize(reflections, 0);
  if (any(greaterThanEqual(pixel, size))) return;
  vec4 here = texelFetch(reflections, pixel, 0);
  int reach = clampedInt(kPixelsOfAlpha * here.a, 0, kMostPixels);
  if (reach > 0 && isVisibleSurface(pixel)) {
    vec3 position = visiblePosition(pixel), normal = visibleUnitNormal(pixel), sum = here.rgb;
    float weights = 1.0;
    for (int i = -kMostPixels; i <= kMostPixels; ++i) {
      ivec2 other = pixel + i * along;
      if (i == 0 || abs(i) > reach || any(lessThan(other, ivec2(0))) || any(greaterThanEqual(other, size))) continue;
      vec4 there = texelFetch(reflections, other, 0);
      if (!(abs(there.a - here.a) <= kSameAlpha * here.a) || !isVisibleSurface(other)) continue;
      vec3 way = visiblePosition(other) - position;
      if (!(abs(dot(way, normal)) <= kSamePlane * length(way))) continue;
      float turned = 2.0 * (1.0 - dot(normal, visibleUnitNormal(other))) / (here.a * here.a),
            apart = float(i) / float(reach);
      float weight = exp(-max(turned, 0.0) - 2.0 * apart * apart);
      sum += weight * there.rgb;
      weights += weight;
    }
    here.rgb = sum / weights;
  }
  imageStore(smoothed, pixel, here);
}
