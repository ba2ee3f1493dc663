// A hierarchy over the texels of a reflective shadow map, for gathering from all of them: a quadtree in a buffer, each
// node the mean of four (shaders/irradiance_cache/gather/tree.glsl). In: a map. Out: nodes, in the map's units: W,
// scene units.
#pragma once

#include "gl/context.hpp"
#include "gl/program.hpp"
#include "rsm/reflective_shadow_map.hpp"

namespace lucerna {

class LightTree {
 public:
  static constexpr int kTop = 4;  ///< depth of the coarsest nodes at most: 2^kTop per side
  /// What a node's area is: of all its texels together, or their mean.
  enum class Area { sum, mean };
  /// size, layers: of the map.
  LightTree(gl::ProgramLibrary& programs, const gl::Capabilities& capabilities, int size, int layers,
            Area area = Area::sum);

  void build(const ReflectiveShadowMap::Outputs& map);
  /// For a program in use that includes tree.glsl; binds the nodes as texels to `unit`.
  void bind(const gl::Program& program, GLuint unit) const;
  int depth() const { return depth_; }
  int top() const { return top_; }  ///< depth of the coarsest nodes
  int layers() const { return layers_; }
  std::size_t gpuBytes() const { return nodes_.bytes(); }
  /// 12 words per node, in the order of tree.glsl; of depths above the coarsest nothing is written. For tests.
  std::vector<GLuint> readNodes() const { return nodes_.buffer().read<GLuint>(); }

 private:
  void setShape(const gl::Program& program) const;
  int size_, layers_, depth_, top_;
  const gl::Program *fromTexels_, *fromNodes_;
  gl::BufferTexture nodes_;
};

}  // namespace lucerna
