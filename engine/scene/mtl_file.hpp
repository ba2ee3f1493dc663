// Material libraries (MTL) of OBJ files (no GL; private to engine/scene). Sources: "Alias/Wavefront MTL material
// format", 1995 (D. Ramey, L. Rose, L. Tyerman); the PBR keys (Pr, Pm, norm) of E. Hornung's proposal for exporters,
// 2014.
//
// Decisions where the format is silent, or files differ from it:
// - A picture's alpha is opacity only where map_d names that picture, or d is below 1.
// - `bump` and `map_Bump` that hold normals, as some exporters write them, are normal maps like `norm`. Maps of heights
//   are not read.
// - Kd is 1 where only map_Kd is given, Ke is 1 where only map_Ke is. Missing g and b are r.
// - A material with d 0 would be invisible; exporters that mix up `d` and `Tr` write it for solid things, so it counts
// as 1.
// - "-clamp on" restricts coordinates, after -s and -o, to 0..1 "rather than repeating copies": outside, the picture's
//   edge is seen, as in other readers of the format. The text says nothing of what else could lie there.
// - illum 5 is a mirror of Ks; illum 4, 6, 7 and 9 with an Ni are a smooth dielectric of that index (Ni 1: a boundary
//   without effect).
// What is not read is one warning a library.
#pragma once

#include "scene/model_parts.hpp"

#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

/// A picture, and the options before its name.
struct MtlPicture {
  std::string file;  ///< empty: none
  glm::dvec2 scale{1.0}, offset{0.0};  ///< looked up at scale * (u, v) + offset
  bool clamped = false;
  float multiplier = 1.0f;  ///< -bm
  PictureUse use() const {
    const TextureWrap wrap = clamped ? TextureWrap::edge : TextureWrap::repeat;
    return {file, {wrap, wrap}};
  }
};

struct MtlMaterial {
  std::string name;
  std::optional<glm::vec3> diffuse, specular, emission;  ///< Kd, Ks, Ke
  std::optional<float> shininess, opacity, ior, metallic, roughness;  ///< Ns; d or 1 - Tr; Ni; Pm; Pr
  int illum = -1;
  MtlPicture diffuseMap, emissionMap, opacityMap, normalMap, bumpMap, metallicMap, roughnessMap;
};

/// The materials of a library. `ignored`: receives the keys and values that are not read.
std::vector<MtlMaterial> readMtl(std::string_view text, std::set<std::string>& ignored);

/// Its picture that decides over the texture coordinates: its colour's, else the first of the others.
const MtlPicture& leadingPicture(const MtlMaterial& material);

/// As the scene has it. `ignored`: see above.
Material materialOf(const MtlMaterial& mtl, TextureLoader& textures, std::set<std::string>& ignored);

}  // namespace lucerna
