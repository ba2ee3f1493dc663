// The animations of a glTF file, which play together from time 0 [GLTF2, 3.11] (no GL; private to engine/scene).
#pragma once

#include "scene/curve.hpp"
#include "scene/gltf_meshes.hpp"

#include <string>
#include <vector>

namespace lucerna {

class GltfAnimations {
 public:
  /// Throws Error(badInput) naming file and key of a sampler or channel that is broken.
  explicit GltfAnimations(const GltfFile& file);

  bool empty() const { return channels_.empty(); }
  double end() const { return end_; }  ///< of the last key, seconds
  std::map<std::size_t, GltfNodePose> at(double seconds) const;
  /// Whether a node's place changes, by its own channels or those of what it hangs on.
  bool moves(std::size_t node) const { return moves_[node]; }
  bool morphs(std::size_t node) const { return morphs_[node]; }
  /// What is not played: two animations of one property, of which the first counts, and targets that are not known.
  const std::string& notPlayed() const { return notPlayed_; }

 private:
  enum class Path { translation, rotation, scale, weights };
  struct Channel {
    std::size_t node;
    Path path;
    Curve curve;
  };
  void addChannel(const GltfFile& file, const Value& animation, const Value& channel);
  Curve curveOf(const GltfFile& file, const Value& sampler, Path path, std::size_t node) const;

  std::vector<Channel> channels_;
  double end_ = 0.0;
  std::vector<bool> moves_, morphs_;
  std::string notPlayed_;
};

}  // namespace lucerna
