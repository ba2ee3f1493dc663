// Draws the parts of a line behind the picture's surfaces faint and dashed.
#include "lib/clamped_int.glsl"
layout(binding = 0) uniform sampler2D depthTexture;
uniform bool hasDepth;
uniform vec2 middle;
uniform vec2 centre;
uniform vec2 scale;
uniform vec2 planes;  // near and far of the depth
uniform float width;
in float vInverseDepth;
in float vAcross;
flat in vec4 vColor;
layout(location = 0) out vec4 displayColor;

void main() {
  float edge = 0.5 * (width + 1.0);
  float alpha = vColor.a * clamp(edge * (1.0 - abs(vAcross)) + 0.25, 0.0, 1.0);
  vec2 place = (gl_FragCoord.xy - middle) / scale + centre;
  if (any(lessThan(place, vec2(0.0))) || any(greaterThan(place, vec2(1.0)))) discard;
  if (hasDepth) {
    ivec2 size = textureSize(depthTexture, 0);
    float depth = texelFetch(depthTexture, clampedInt(place * vec2(size), ivec2(0), size - 1), 0).r;
    float surface = planes.x * planes.y / mix(planes.y, planes.x, depth);
    bool dash = fract((gl_FragCoord.x + gl_FragCoord.y) / 8.0) < 0.5;
    if (1.0 / vInverseDepth > 1.01 * surface) alpha *= dash ? 0.45 : 0.08;
  }
  displayColor = vec4(vColor.rgb, alpha);
}
