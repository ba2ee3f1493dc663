// A mesh's material. Flags leave out what no mesh of the scene has.
// Sampled first in a fragment shader, before `discard` and outside of any branch: which mip level is read comes of differences between
// neighbouring invocations, and those are undefined after non-uniform control flow, of which discarding is one [GLSL 4.30, 8.13.1, 8.9].
uniform vec3 materialDiffuse;
#if DIFFUSE_TEXTURES
layout(binding = 0) uniform sampler2D diffuseTexture;  // white where a material has none
#endif
#if ALPHA_MASK
layout(binding = 1) uniform sampler2D maskTexture;
#endif

vec3 materialAlbedo(vec2 texCoord) {
#if DIFFUSE_TEXTURES
  return materialDiffuse * texture(diffuseTexture, texCoord).rgb;
#else
  return materialDiffuse;
#endif
}

bool materialCutOut(vec2 texCoord) {
#if ALPHA_MASK
  return texture(maskTexture, texCoord).r < 0.5;
#else
  return false;
#endif
}
