// Normal mapping with glTF's convention [GLTF2, section 3.9.3]: x along the tangent, y along the bitangent, z along the
// surface normal. The tangent is the direction of increasing u, perpendicular to the normal; the bitangent is
// perpendicular to both, on the side of increasing v. Both are derived from the triangle's corners, so no vertex stores
// them. That is exact for affine texture coordinates; on curved meshes it differs slightly from tangents interpolated
// between vertices [Mikkelsen2008].

// normal: unit. e1, e2: two steps on the surface; t1, t2: the same steps in texture coordinates, v = 0 at the bottom.
// mapped: the picture's normal, scaled.
vec3 normalFromMap(vec3 normal, vec3 e1, vec3 e2, vec2 t1, vec2 t2, vec3 mapped) {
  float area = t1.x * t2.y - t2.x * t1.y;
  if (area == 0.0) return normal;  // no tangent without texture coordinates
  vec3 alongU = (e1 * t2.y - e2 * t1.y) * sign(area), alongV = (e2 * t1.x - e1 * t2.x) * sign(area);
  vec3 tangent = alongU - normal * dot(normal, alongU);
  float length2 = dot(tangent, tangent);
  if (!(length2 > 0.0)) return normal;
  tangent *= inversesqrt(length2);
  vec3 bitangent = cross(normal, tangent);
  if (dot(bitangent, alongV) < 0.0) bitangent = -bitangent;  // mirrored texture coordinates
  return normalize(mapped.x * tangent + mapped.y * bitangent + mapped.z * normal);
}

// Decodes a texel with values in 0..1.
vec3 decodedNormal(vec3 texel, float scale) { return (2.0 * texel - 1.0) * vec3(scale, scale, 1.0); }
