// Normals from a picture, as glTF has them [GLTF2, section 3.9.3]: x along the tangent, y along the bitangent, z along
// the surface's normal. The tangent is the direction in which u grows, across the normal; the bitangent stands on both,
// on the side to which v grows. Both follow from a triangle's corners, so that no vertex carries them: exact where
// texture coordinates are affine, and on curved meshes a little off the tangents that are interpolated between vertices
// [Mikkelsen2008].

// normal: unit. e1, e2: two steps on the surface; t1, t2: those steps in texture coordinates, v = 0 at the bottom.
// mapped: of the picture, scaled.
vec3 normalFromMap(vec3 normal, vec3 e1, vec3 e2, vec2 t1, vec2 t2, vec3 mapped) {
  float area = t1.x * t2.y - t2.x * t1.y;
  if (area == 0.0) return normal;  // without texture coordinates there is no tangent
  vec3 alongU = (e1 * t2.y - e2 * t1.y) * sign(area), alongV = (e2 * t1.x - e1 * t2.x) * sign(area);
  vec3 tangent = alongU - normal * dot(normal, alongU);
  float length2 = dot(tangent, tangent);
  if (!(length2 > 0.0)) return normal;
  tangent *= inversesqrt(length2);
  vec3 bitangent = cross(normal, tangent);
  if (dot(bitangent, alongV) < 0.0) bitangent = -bitangent;  // mirrored coordinates
  return normalize(mapped.x * tangent + mapped.y * bitangent + mapped.z * normal);
}

// From a texel in 0..1.
vec3 decodedNormal(vec3 texel, float scale) { return (2.0 * texel - 1.0) * vec3(scale, scale, 1.0); }
