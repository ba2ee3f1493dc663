// Displays an intermediate picture as colours: light scaled by a factor; normals and positions mapped from -1..1 and
// the scene's bounds; depth from white (near) to black.
// SHAPE: 0 2D, 1 a layer of an array, 2 a slice of a volume, 3 a slice of three volumes: red, green and blue.
#include "lib/sh.glsl"
in vec2 uv;
#if SHAPE == 0
layout(binding = 0) uniform sampler2D picture;
#elif SHAPE == 1
layout(binding = 0) uniform sampler2DArray picture;
#else
layout(binding = 0) uniform sampler3D picture;
#endif
#if SHAPE == 3
layout(binding = 1) uniform sampler3D green;
layout(binding = 2) uniform sampler3D blue;
#endif
uniform int layer;
// StagePicture::Kind: 0 position, 1 normal, 2 flux, 3 depth, 4 irradiance of records, 5 coefficients, 6 samples
uniform int kind;
uniform float factor;  // scales light
uniform vec3 minimum;  // of the scene
uniform vec3 extent;
layout(location = 0) out vec4 color;

void main() {
  ivec2 place = ivec2(gl_FragCoord.xy);
#if SHAPE == 0
  vec4 value = texelFetch(picture, place, 0);
#else
  vec4 value = texelFetch(picture, ivec3(place, layer), 0);
#endif
#if SHAPE == 3
  // Mean intensity over the sphere: band 0 alone.
  value = vec4(
      kY00 * vec3(value.x, texelFetch(green, ivec3(place, layer), 0).x, texelFetch(blue, ivec3(place, layer), 0).x),
      1.0);
#endif
  vec3 shown = factor * value.rgb;
  if (kind == 0) shown = value.w > 0.0 ? (value.xyz - minimum) / extent : vec3(0.0);
  if (kind == 1) shown = dot(value.xyz, value.xyz) > 0.0 ? 0.5 * value.xyz + 0.5 : vec3(0.0);
  // Perspective depth is concentrated near 1: the fourth root of the distance from 1 spreads it best.
  if (kind == 3) shown = vec3(pow(clamp(1.0 - value.r, 0.0, 1.0), 0.25));
  if (kind == 4) shown = value.w > 0.0 ? factor * value.rgb / value.w : vec3(0.0);
  // Black (0) through red and yellow to white (16).
  if (kind == 6) shown = clamp(vec3(3.0, 3.0, 3.0) * value.a / 16.0 - vec3(0.0, 1.0, 2.0), 0.0, 1.0);
  color = vec4(shown, 1.0);
}
