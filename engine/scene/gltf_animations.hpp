// The animations of a glTF file, which play together from time 0 [GLTF2, 3.11] (no GL; private to engine/scene). With
// KHR_animation_pointer also those of factors of materials, and of lights' colours.
#pragma once

#include "scene/curve.hpp"
#include "scene/gltf_material.hpp"
#include "scene/gltf_meshes.hpp"

#include <string>
#include <vector>

namespace lucerna {

class GltfAnimations {
 public:
  /// Throws Error(badInput) naming file and key of a sampler or channel that is broken.
  explicit GltfAnimations(const GltfFile& file);

  bool empty() const { return channels_.empty() && properties_.empty(); }
  double end() const { return end_; }  ///< of the last key, seconds
  std::map<std::size_t, GltfNodePose> at(double seconds) const;
  /// Whether a node's place changes, by its own channels or those of what it hangs on.
  bool moves(std::size_t node) const { return moves_[node]; }
  bool morphs(std::size_t node) const { return morphs_[node]; }
  bool movesMaterial(std::size_t material) const { return movesAny(kMaterials, material); }
  /// A material's factors at a time; others stay.
  void setMaterial(GltfMaterial& gltf, std::size_t material, double seconds) const;
  bool movesLight(std::size_t light) const { return movesAny(kLights, light); }
  /// Colour times intensity at a time; `colour`, `intensity`: at rest.
  glm::vec3 lightAt(std::size_t light, glm::dvec3 colour, double intensity, double seconds) const;
  /// What is not played: two animations of one property, of which the first counts, and targets that are not known.
  const std::string& notPlayed() const { return notPlayed_; }

 private:
  enum class Path { translation, rotation, scale, weights };
  struct Channel {
    std::size_t node;
    Path path;
    Curve curve;
  };
  static constexpr std::string_view kMaterials = "materials", kLights = "extensions/KHR_lights_punctual/lights";
  /// Of a member of an array of the file.
  struct Property {
    std::string_view array, name;
    std::size_t index;
    Curve curve;
  };
  void addChannel(const GltfFile& file, const Value& animation, const Value& channel);
  bool addProperty(const GltfFile& file, const Value& sampler, const std::string& pointer);
  bool movesAny(std::string_view array, std::size_t index) const;
  /// The value of a property at a time, empty if nothing moves it.
  std::vector<double> valueAt(std::string_view array, std::size_t index, std::string_view name, double seconds) const;

  std::vector<Channel> channels_;
  std::vector<Property> properties_;
  double end_ = 0.0;
  std::vector<bool> moves_, morphs_;
  std::string notPlayed_;
};

}  // namespace lucerna
