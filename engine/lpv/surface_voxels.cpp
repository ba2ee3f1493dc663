#include "lpv/surface_voxels.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <cmath>

namespace lucerna {

bool isCutOut(const Scene& scene, const Material& material, const glm::dvec2& texCoord) {
  const int index = material.alphaTexture >= 0 ? material.alphaTexture : material.diffuseTexture;
  if (!material.alphaMasked || index < 0) return false;
  const Bitmap& bitmap = scene.textures[static_cast<std::size_t>(index)].bitmap;
  if (bitmap.width <= 0 || bitmap.height <= 0) return false;
  const auto texel = [](double t, int size) {
    return std::clamp(static_cast<int>((t - std::floor(t)) * size), 0, size - 1);
  };
  const int x = texel(texCoord.x, bitmap.width), y = bitmap.height - 1 - texel(texCoord.y, bitmap.height);
  const std::size_t at =
      4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(bitmap.width) + static_cast<std::size_t>(x));
  return bitmap.rgba[at + (bitmap.hasAlpha ? 3 : 0)] < 128;
}

bool SurfaceVoxels::isSet(const glm::ivec3& voxel) const {
  const glm::ivec3 brick = voxel / kBrick, within = voxel % kBrick;
  const glm::uvec2 words = bits[(static_cast<std::size_t>(brick.z) * static_cast<std::size_t>(bricks.y) +
                                 static_cast<std::size_t>(brick.y)) *
                                    static_cast<std::size_t>(bricks.x) +
                                static_cast<std::size_t>(brick.x)];
  const int bit = (within.z * kBrick + within.y) * kBrick + within.x;
  return ((bit < 32 ? words.x : words.y) >> (bit & 31) & 1u) != 0;
}

SurfaceVoxels surfaceVoxels(const Scene& scene, int across) {
  CHECK(across >= 1 && across <= 1024, "{} voxels", across);
  SurfaceVoxels voxels;
  const glm::dvec3 extent = scene.bounds.extent();
  const double longest = std::max({extent.x, extent.y, extent.z});
  voxels.size = longest > 0.0 ? longest / across : 1.0;
  voxels.minimum =
      scene.bounds.empty() ? glm::dvec3(0.0) : scene.bounds.min - voxels.size;  // a voxel of air around the scene
  for (int axis = 0; axis < 3; ++axis)
    voxels.bricks[axis] = static_cast<int>(std::ceil((extent[axis] / voxels.size + 2.0) / SurfaceVoxels::kBrick)) + 1;
  voxels.bits.assign(static_cast<std::size_t>(voxels.bricks.x) * static_cast<std::size_t>(voxels.bricks.y) *
                         static_cast<std::size_t>(voxels.bricks.z),
                     glm::uvec2(0u));
  const auto set = [&](const glm::dvec3& inVoxels) {
    const glm::ivec3 voxel =
        glm::clamp(glm::ivec3(glm::floor(inVoxels)), glm::ivec3(0), SurfaceVoxels::kBrick * voxels.bricks - 1);
    const glm::ivec3 brick = voxel / SurfaceVoxels::kBrick, within = voxel % SurfaceVoxels::kBrick;
    glm::uvec2& words = voxels.bits[(static_cast<std::size_t>(brick.z) * static_cast<std::size_t>(voxels.bricks.y) +
                                     static_cast<std::size_t>(brick.y)) *
                                        static_cast<std::size_t>(voxels.bricks.x) +
                                    static_cast<std::size_t>(brick.x)];
    const int bit = (within.z * SurfaceVoxels::kBrick + within.y) * SurfaceVoxels::kBrick + within.x;
    (bit < 32 ? words.x : words.y) |= 1u << (bit & 31);
  };
  for (const Mesh& mesh : scene.meshes) {
    const Material& material = scene.materials[static_cast<std::size_t>(mesh.material)];
    for (std::uint32_t i = mesh.firstIndex; i + 2 < mesh.firstIndex + mesh.indexCount; i += 3) {
      glm::dvec3 corners[3];
      glm::dvec2 texCoords[3];
      for (std::uint32_t k = 0; k < 3; ++k) {
        const Vertex& vertex = scene.vertices[scene.indices[i + k]];
        corners[k] = (glm::dvec3(vertex.position) - voxels.minimum) / voxels.size;
        texCoords[k] = vertex.texCoord;
      }
      // Sample points in rows along two edges, half a voxel apart.
      const double edge = std::max({glm::length(corners[1] - corners[0]), glm::length(corners[2] - corners[0]),
                                    glm::length(corners[2] - corners[1])});
      const int steps = std::max(1, static_cast<int>(std::ceil(2.0 * edge)));
      for (int u = 0; u <= steps; ++u)
        for (int v = 0; u + v <= steps; ++v) {
          const double b = static_cast<double>(u) / steps, c = static_cast<double>(v) / steps, a = 1.0 - b - c;
          if (isCutOut(scene, material, a * texCoords[0] + b * texCoords[1] + c * texCoords[2])) continue;
          set(a * corners[0] + b * corners[1] + c * corners[2]);
        }
    }
  }
  return voxels;
}

}  // namespace lucerna
