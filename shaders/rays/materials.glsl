// Evaluates a ray's hit: position, normals and material. Storage blocks 2 (triangles) and 3 (materials). Textures lie
// in one atlas. They are read bilinearly from the finest level, since many paths per pixel filter them.
#include "lib/clamped_int.glsl"
#include "shared/bindings.h"
#if TEXTURES || ALPHA_MASKS
layout(binding = 0) uniform sampler2DArray textureAtlas;
#endif
#if NORMAL_MAPS || METAL_MAPS
layout(binding = UNIT_VALUE_ATLAS) uniform sampler2DArray valueAtlas;  // for pictures that are not sRGB-encoded
#endif
#if NORMAL_MAPS
#include "lib/normal_map.glsl"
#endif
#if COATS
#include "lib/coat.glsl"
#endif

// TRIANGLE_WORDS uvec4 per triangle, floats as their bits:
// 0: first corner, material; 1: second corner, geometric normal x; 2: third corner, geometric normal y; 3: geometric
// normal z, the third corner's texture coordinates, bits of pickDensity (with LIGHT_HIERARCHY lampLeaf). With TEXTURES
// or ALPHA_MASKS these are followed by the first and second corners' texture coordinates, with SMOOTH_NORMALS by the
// corners' normals.
layout(std430, binding = 2) readonly restrict buffer TriangleBlock { uvec4 triangleData[]; };
layout(std430, binding = 3) readonly restrict buffer MaterialBlock { PathMaterial materials[]; };

struct Surface {
  vec3 position;
  float magnitude;       // largest coordinate of the triangle's corners; determines the rounding of `position`
  vec3 geometricNormal;  // unit, on the side the ray came from
  bool front;            // whether that is the triangle's front
  vec3 normal;           // for shading, unit; flipped together with the geometric one
  uint material;
  vec2 texCoord;
#if SMOOTH_NORMALS
  vec2 barycentrics;
#endif
};

#if TEXTURES || ALPHA_MASKS
vec2 texCoordAt(uint triangle, vec2 barycentrics) {
  uint first = triangle * TRIANGLE_WORDS;
  vec4 ab = uintBitsToFloat(triangleData[first + 4u]);
  vec2 c = uintBitsToFloat(triangleData[first + 3u].yz);
  return ab.xy + barycentrics.x * (ab.zw - ab.xy) + barycentrics.y * (c - ab.xy);
}

// Bilinear between texel centres, as OpenGL's filter is [OpenGL 4.3, 8.14.2]. Beyond the edge lie the texels of
// the other side or, clamped or mirrored, those of the edge again.
vec4 readAtlas(sampler2DArray atlas, PathTexture t, vec2 texCoord) {
  ivec2 size = ivec2(t.width, t.height);
  vec2 place = fract(texCoord);
#if TEXTURE_WRAPS
  ivec2 wrap = ivec2(t.wrapU, t.wrapV);
  vec2 mirrored = 1.0 - abs(1.0 - 2.0 * fract(0.5 * texCoord));
  place = mix(place, clamp(texCoord, 0.0, 1.0), equal(wrap, ivec2(PATH_WRAP_EDGE)));
  place = mix(place, mirrored, equal(wrap, ivec2(PATH_WRAP_MIRROR)));
#endif
  vec2 p = place * vec2(size) - 0.5;
  vec2 floored = floor(p);
  vec2 f = p - floored;
  ivec2 low = clampedInt(floored, ivec2(-1), size - 1), high = low + 1;
#if TEXTURE_WRAPS
  bvec2 repeats = equal(wrap, ivec2(PATH_WRAP_REPEAT));
  low = ivec2(repeats.x ? low.x : max(low.x, 0), repeats.y ? low.y : max(low.y, 0));
  high = ivec2(repeats.x ? high.x : min(high.x, size.x - 1), repeats.y ? high.y : min(high.y, size.y - 1));
#endif
  low += size * ivec2(lessThan(low, ivec2(0)));
  high -= size * ivec2(greaterThanEqual(high, size));
  ivec2 corner = ivec2(t.x, t.y);
  vec4 a = texelFetch(atlas, ivec3(corner + low, t.layer), 0);
  vec4 b = texelFetch(atlas, ivec3(corner + ivec2(high.x, low.y), t.layer), 0);
  vec4 c = texelFetch(atlas, ivec3(corner + ivec2(low.x, high.y), t.layer), 0);
  vec4 d = texelFetch(atlas, ivec3(corner + high, t.layer), 0);
  return mix(mix(a, b, f.x), mix(c, d, f.x), f.y);
}

vec4 readTexture(PathTexture t, vec2 texCoord) { return readAtlas(textureAtlas, t, texCoord); }
#endif

#if ALPHA_MASKS
// Called by the ray caster. Alpha below one half is cut out.
bool isCutOut(uint triangle, vec2 barycentrics) {
  uint material = triangleData[triangle * TRIANGLE_WORDS].w;
  PathTexture mask = materials[material].maskTexture;  // see pathtracer/crossing.glsl, mediumOf()
  return readTexture(mask, texCoordAt(triangle, barycentrics)).a < 0.5;
}
#endif

// Of the triangle's front, unit.
vec3 normalOf(uint triangle) {
  uint first = triangle * TRIANGLE_WORDS;
  return uintBitsToFloat(uvec3(triangleData[first + 1u].w, triangleData[first + 2u].w, triangleData[first + 3u].x));
}

Surface surfaceAt(uint triangle, vec2 barycentrics, vec3 direction) {
  uint first = triangle * TRIANGLE_WORDS;
  uvec4 words0 = triangleData[first], words1 = triangleData[first + 1u], words2 = triangleData[first + 2u];
  vec3 a = uintBitsToFloat(words0.xyz), b = uintBitsToFloat(words1.xyz), c = uintBitsToFloat(words2.xyz);
  float wa = 1.0 - barycentrics.x - barycentrics.y;
  Surface surface;
  surface.position = wa * a + barycentrics.x * b + barycentrics.y * c;
  vec3 largest = max(abs(a), max(abs(b), abs(c)));
  surface.magnitude = max(largest.x, max(largest.y, largest.z));
  surface.material = words0.w;
#if SMOOTH_NORMALS
  surface.barycentrics = barycentrics;
#endif
  vec3 normal = uintBitsToFloat(uvec3(words1.w, words2.w, triangleData[first + 3u].x));
  surface.front = dot(normal, direction) < 0.0;
  surface.geometricNormal = surface.front ? normal : -normal;
#if SMOOTH_NORMALS
  uint n = first + TRIANGLE_WORDS - 3u;
  vec3 smoothed = wa * uintBitsToFloat(triangleData[n].xyz) +
                  barycentrics.x * uintBitsToFloat(triangleData[n + 1u].xyz) +
                  barycentrics.y * uintBitsToFloat(triangleData[n + 2u].xyz);
  float length2 = dot(smoothed, smoothed);
  // Flipped by the side of the face alone, as in forward/surface.glsl; opposite normals at the corners may cancel.
  surface.normal =
      length2 > 1e-12 ? (surface.front ? smoothed : -smoothed) * inversesqrt(length2) : surface.geometricNormal;
#else
  surface.normal = surface.geometricNormal;
#endif
#if TEXTURES || ALPHA_MASKS
  surface.texCoord = texCoordAt(triangle, barycentrics);
#endif
  return surface;
}

vec3 colourAt(Surface surface) {
  vec3 colour = materials[surface.material].albedo;
#if TEXTURES
  PathTexture t = materials[surface.material].diffuseTexture;
  if (t.layer >= 0) colour *= readTexture(t, surface.texCoord).rgb;
#endif
  return colour;
}

#if METAL_MAPS
// Factors from a MetalMap: x for the square root of the roughness, y the metallic share.
vec2 metalAt(Surface surface) {
  PathTexture t = materials[surface.material].metalTexture;
  vec2 map = t.layer >= 0 ? readAtlas(valueAtlas, t, surface.texCoord).gb : vec2(1.0);
  return vec2(map.x, max(materials[surface.material].metallic, 0.0) * map.y);
}

#endif

vec3 albedoAt(Surface surface) {
  vec3 albedo = colourAt(surface);
#if METAL_MAPS
  albedo *= 1.0 - metalAt(surface).y;
#endif
  return albedo;
}

#if COATS
Coat coatAt(Surface surface) {
#if METAL_MAPS
  float roughness = materials[surface.material].mapRoughness;
  if (roughness >= 0.0) {
    vec2 metal = metalAt(surface);
    roughness *= metal.x;
    return Coat(mix(vec3(0.04), colourAt(surface), metal.y), clamp(roughness * roughness, COAT_LEAST_ALPHA, 1.0));
  }
#endif
  return Coat(materials[surface.material].specular, materials[surface.material].roughness);
}
#endif

// The albedo of the surface taken as Lambertian.
vec3 wholeAlbedoAt(Surface surface) {
#if COATS
  return wholeReflectance(coatAt(surface), albedoAt(surface));
#else
  return albedoAt(surface);
#endif
}

#if NORMAL_MAPS
// Applies the material's normal map to the shading normal; flipped like the surface's normals.
void applyNormalMap(inout Surface surface, uint triangle) {
  PathTexture t = materials[surface.material].normalTexture;
  if (t.layer < 0) return;
  uint first = triangle * TRIANGLE_WORDS;
  vec3 a = uintBitsToFloat(triangleData[first].xyz);
  vec4 ab = uintBitsToFloat(triangleData[first + 4u]);
  vec2 c = uintBitsToFloat(triangleData[first + 3u].yz);
  vec3 mapped = decodedNormal(readAtlas(valueAtlas, t, surface.texCoord).xyz, materials[surface.material].normalScale);
  float side = surface.front ? 1.0 : -1.0;
  surface.normal =
      side * normalFromMap(side * surface.normal, uintBitsToFloat(triangleData[first + 1u].xyz) - a,
                           uintBitsToFloat(triangleData[first + 2u].xyz) - a, ab.zw - ab.xy, c - ab.xy, mapped);
}
#endif

#if EMISSION
// Probability per unit area that a light drawn by power falls on a point of the triangle.
#if LIGHT_HIERARCHY
#include "rays/light_leaves.glsl"
uint lampLeaf(uint triangle) { return triangleData[triangle * TRIANGLE_WORDS + 3u].w; }  // of an emissive triangle
float pickDensity(uint triangle) { return uintBitsToFloat(lampOfLeaf(lampLeaf(triangle)).y); }
#else
float pickDensity(uint triangle) { return uintBitsToFloat(triangleData[triangle * TRIANGLE_WORDS + 3u].w); }
#endif

vec3 emissionAt(uint material, uint triangle, vec2 barycentrics) {
  vec3 emission = materials[material].emission;
#if TEXTURES
  PathTexture t = materials[material].emissionTexture;
  if (t.layer >= 0) emission *= readTexture(t, texCoordAt(triangle, barycentrics)).rgb;
#endif
  return emission;
}
#endif
