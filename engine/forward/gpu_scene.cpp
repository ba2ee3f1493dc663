#include "forward/gpu_scene.hpp"

#include "base/error.hpp"
#include "forward/mask_levels.hpp"
#include "forward/texture_wraps.hpp"
#include "gl/draw.hpp"
#include "scene/coat.hpp"
#include "shared/bindings.h"
#include "shared/coat.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <utility>

namespace lucerna {

namespace {

int mipLevels(int width, int height) { return 1 + static_cast<int>(std::floor(std::log2(std::max(width, height)))); }

// A Bitmap has its top row first, OpenGL the bottom row (v = 0).
std::vector<std::uint8_t> flippedRows(const Bitmap& bitmap) {
  const std::size_t row = 4 * static_cast<std::size_t>(bitmap.width);
  std::vector<std::uint8_t> flipped(bitmap.rgba.size());
  for (int y = 0; y < bitmap.height; ++y)
    std::copy_n(
        bitmap.rgba.begin() + static_cast<std::ptrdiff_t>(row * static_cast<std::size_t>(bitmap.height - 1 - y)), row,
        flipped.begin() + static_cast<std::ptrdiff_t>(row * static_cast<std::size_t>(y)));
  return flipped;
}

constexpr std::array<gl::VertexArray::Attribute, 3> kAttributes{
    {{0, 3, offsetof(Vertex, position)}, {1, 2, offsetof(Vertex, texCoord)}, {2, 3, offsetof(Vertex, normal)}}};

bool outsideFrustum(const glm::mat4& clipFromWorld, const glm::vec3& centre, const glm::vec3& halfExtent) {
  const glm::mat4 rows = glm::transpose(clipFromWorld);
  for (int axis = 0; axis < 3; ++axis)
    for (float sign : {1.0f, -1.0f}) {
      const glm::vec4 plane = rows[3] + sign * rows[axis];  // inside: dot(plane, (p, 1)) >= 0
      const glm::vec3 normal(plane);
      if (glm::dot(normal, centre) + glm::dot(glm::abs(normal), halfExtent) + plane.w < 0.0f) return true;
    }
  return false;
}

}  // namespace

GpuScene::GpuScene(const Scene& scene, const SceneFeatures& features, const gl::Capabilities& capabilities,
                   const GpuSceneSettings& settings)
    : scene_(&scene),
      features_(features),
      boundaries_(settings.boundaries),
      isSoftware_(capabilities.softwareRenderer) {
  gl::Sampling sampling{settings.mipmaps ? gl::Filter::linearMipmaps : gl::Filter::linear, gl::Filter::linear};
  // Each of n samples covers 1 / sqrt(n) of a pixel's width, so that samples alone filter pixels whose sides on the
  // texture differ by as much.
  const float samplesAcross = std::sqrt(static_cast<float>(settings.pixelSamples));
  sampling.bias = -std::log2(samplesAcross);
  // Without mipmaps a software renderer reads every texel below a pixel, thousands where the picture is small.
  const bool anisotropic = capabilities.anisotropicFilter && settings.mipmaps;
  const gl::Sampling isotropic = sampling;
  if (anisotropic)
    sampling.anisotropy = std::max(std::min(settings.anisotropy, capabilities.maxAnisotropy) / samplesAcross, 1.0f);

  struct Use {
    const char* name;
    gl::Format format;
  };
  constexpr Use kColour{"albedo", gl::Format::srgb8Alpha8}, kMask{"mask", gl::Format::r8},
      kLinear{"values", gl::Format::rgba8};
  std::map<std::pair<int, gl::Format>, int> known;  // a picture may be a colour for one material and a mask for another
  const auto upload = [&](int index, const Use& use) {
    const auto [place, isNew] = known.try_emplace({index, use.format}, static_cast<int>(textures_.size()));
    if (!isNew) return place->second;
    const Texture& texture = scene.textures[static_cast<std::size_t>(index)];
    const Bitmap& bitmap = texture.bitmap;
    const std::string name = fmt::format("{} {}", use.name, texture.file.filename().string());
    const glm::ivec2 size(bitmap.width, bitmap.height);
    std::vector<std::uint8_t> texels = flippedRows(bitmap);
    if (use.format == gl::Format::r8) {
      const std::size_t channel = bitmap.hasAlpha ? 3 : 0;
      for (std::size_t i = 0; i < texels.size() / 4; ++i) texels[i] = texels[4 * i + channel];
      texels.resize(texels.size() / 4);
      const std::vector<std::vector<std::uint8_t>> smaller = maskLevels(texels, size, texture.wraps);
      // Their coverage holds for trilinear lookups alone.
      gl::Texture& target = textures_.emplace_back(name, use.format, size, withWraps(isotropic, texture.wraps),
                                                   1 + static_cast<int>(smaller.size()));
      target.upload(gl::Texels::redByte, texels.data());
      for (std::size_t i = 0; i < smaller.size(); ++i)
        target.upload(gl::Texels::redByte, smaller[i].data(), 1 + static_cast<int>(i));
      return place->second;
    }
    gl::Texture& target = textures_.emplace_back(name, use.format, size, withWraps(sampling, texture.wraps),
                                                 mipLevels(bitmap.width, bitmap.height));
    target.upload(gl::Texels::rgbaByte, texels.data());
    target.generateMipmaps();
    return place->second;
  };

  // Materials, with the textures that the scene needs.
  for (const Material& material : scene.materials) {
    Surface surface{};
    setValues(surface, material);
    if (features.diffuseTextures && material.diffuseTexture >= 0) {
      surface.diffuseTexture = upload(material.diffuseTexture, kColour);
      const TextureWraps wraps = scene.textures[static_cast<std::size_t>(material.diffuseTexture)].wraps;
      if (sampling.anisotropy > 1.0f)
        surface.isotropic = &isotropic_.try_emplace(wraps, "isotropic", withWraps(isotropic, wraps)).first->second;
    }
    surface.masked = features.alphaMasks && material.alphaMasked;
    if (surface.masked)
      surface.maskTexture = upload(material.alphaTexture >= 0 ? material.alphaTexture : material.diffuseTexture, kMask);
    if (features.emissionTextures && material.emissionTexture >= 0)
      surface.emissionTexture = upload(material.emissionTexture, kColour);
    if (features.normalMaps && material.normalTexture >= 0) {
      surface.normalScale = material.normalScale;
      surface.normalTexture = upload(material.normalTexture, kLinear);
    }
    if (material.metalMap && material.metalMap->texture >= 0)
      surface.metalTexture = upload(material.metalMap->texture, kLinear);
    surfaces_.push_back(surface);
  }
  if (features.specular) {
    coats_.emplace("coats", gl::Format::rgba32f, glm::ivec2(COAT_COSINES, COAT_ALPHAS),
                   gl::Sampling{gl::Filter::linear, gl::Filter::linear});
    coats_->upload(gl::Texels::rgbaFloat, coatTable().data());
  }
  if (features.diffuseTextures || features.emissionTextures || features.normalMaps || features.metalMaps) {
    white_.emplace("white", gl::Format::rgba8, glm::ivec2(1));
    const std::array<std::uint8_t, 4> texel{255, 255, 255, 255};
    white_->upload(gl::Texels::rgbaByte, texel.data());
  }
  uploadMeshes();
}

// Opaque meshes first, so that a depth pass draws them in one call; then grouped by material.
void GpuScene::uploadMeshes() {
  const Scene& scene = *scene_;
  std::vector<const Mesh*> order;
  for (const Mesh& mesh : scene.meshes)
    if (boundaries_ || scene.materials[static_cast<std::size_t>(mesh.material)].bsdf != Bsdf::none)
      order.push_back(&mesh);
  const auto isMasked = [&](const Mesh* mesh) { return surfaces_[static_cast<std::size_t>(mesh->material)].masked; };
  std::stable_sort(order.begin(), order.end(), [&](const Mesh* a, const Mesh* b) {
    return std::pair(isMasked(a), a->material) < std::pair(isMasked(b), b->material);
  });
  std::vector<std::uint32_t> indices;
  indices.reserve(scene.indices.size());
  for (const Mesh* mesh : order) {
    const Draw draw{
        static_cast<std::uint32_t>(indices.size()), mesh->indexCount, mesh->material, glm::vec3(mesh->bounds.centre()),
        glm::vec3(0.5 * mesh->bounds.extent()),     mesh->firstIndex};
    const auto first = scene.indices.begin() + mesh->firstIndex;
    indices.insert(indices.end(), first, first + mesh->indexCount);
    (isMasked(mesh) ? all_.masked_ : all_.opaque_).push_back(draw);
  }
  CHECK(all_.masked_.empty() || features_.alphaMasks, "{} masked meshes", all_.masked_.size());

  vertices_ = gl::Buffer("scene vertices", scene.vertices.size() * sizeof(Vertex), scene.vertices.data(),
                         gl::Usage::staticDraw);
  if (indices.empty()) throwBadInput("{}: nothing but boundaries of media", scene.file.string());
  uploadIndices("scene", indices, all_);
}

void GpuScene::setValues(Surface& surface, const Material& material) const {
  const bool isCoated = hasCoat(material), isSmooth = !isCoated && material.bsdf != Bsdf::diffuse;
  surface.diffuse = isCoated && material.bsdf == Bsdf::conductor ? glm::vec3(0.0f) : material.diffuse;
  surface.specular = material.bsdf == Bsdf::dielectric ? glm::vec3(0.0f) : material.specular;
  surface.emission =
      features_.emissionTextures && material.emissionTexture >= 0 ? material.emissionScale : material.emission;
  surface.alpha = isSmooth ? 0.0f : std::max(material.roughness, static_cast<float>(COAT_LEAST_ALPHA));
  if (!material.metalMap) return;
  surface.diffuse = material.metalMap->base;
  surface.metallic = material.metalMap->metallic;
  surface.roughness = material.metalMap->roughness;
}

void GpuScene::replaceMeshes() {
  for (std::size_t i = 0; i < surfaces_.size(); ++i) setValues(surfaces_[i], scene_->materials[i]);
  all_ = {};
  forgetPlaces();
  ++poses_;
  uploadMeshes();
}

void GpuScene::update(const std::vector<std::size_t>& meshes) {
  for (std::size_t i = 0; i < surfaces_.size(); ++i) setValues(surfaces_[i], scene_->materials[i]);
  if (!meshes.empty()) ++poses_;
  for (const std::size_t index : meshes) {
    const Mesh& mesh = scene_->meshes[index];
    const VertexRange range = vertexRange(*scene_, mesh);
    vertices_.upload(range.first * sizeof(Vertex), range.count * sizeof(Vertex), &scene_->vertices[range.first]);
    if (before_.id() != 0) movedVertices_.push_back(range);
    for (std::vector<Draw>* draws : {&all_.opaque_, &all_.masked_})
      for (Draw& draw : *draws) {
        if (draw.firstInScene != mesh.firstIndex || mesh.indexCount == 0) continue;
        if (!std::exchange(draw.moves, true)) ++movingMeshes_;
        draw.hasMoved = true;
        draw.centre = glm::vec3(mesh.bounds.centre());
        draw.halfExtent = glm::vec3(0.5 * mesh.bounds.extent());
        all_.indices_.upload(draw.firstIndex * sizeof(std::uint32_t), mesh.indexCount * sizeof(std::uint32_t),
                             &scene_->indices[mesh.firstIndex]);
      }
  }
}

void GpuScene::keepPlaces() {
  if (movingMeshes_ == 0) return;
  if (before_.id() == 0) {
    before_ = gl::Buffer("vertices before", vertices_.bytes(), nullptr, gl::Usage::dynamicDraw);
    withBefore_ = gl::VertexArray("vertices and before", vertices_, sizeof(Vertex), kAttributes, &all_.indices_);
    const std::array<gl::VertexArray::Attribute, 1> place{{{kPlaceBefore, 3, offsetof(Vertex, position)}}};
    withBefore_.add(before_, sizeof(Vertex), place);
    vertices_.copyTo(before_, vertices_.bytes());
  }
  for (const VertexRange& range : movedVertices_)
    vertices_.copyTo(before_, range.count * sizeof(Vertex), range.first * sizeof(Vertex));
  movedVertices_.clear();
  for (std::vector<Draw>* draws : {&all_.opaque_, &all_.masked_})
    for (Draw& draw : *draws) draw.hasMoved = false;
}

void GpuScene::drawMoved(const SurfacePrograms& programs) const {
  withBefore_.bind();
  for (const bool masked : {false, true})
    for (const Draw& draw : masked ? all_.masked_ : all_.opaque_) {
      if (!draw.hasMoved) continue;
      const gl::Program& program = masked ? *programs.masked : *programs.opaque;
      program.use();
      bindSurface(program, surfaces_[static_cast<std::size_t>(draw.surface)], false);
      drawRange(draw);
    }
}

void GpuScene::uploadIndices(const std::string& name, const std::vector<std::uint32_t>& indices, Selection& to) const {
  to.indices_ =
      gl::Buffer(name + " indices", indices.size() * sizeof(std::uint32_t), indices.data(), gl::Usage::staticDraw);
  to.vertexArray_ = gl::VertexArray(name, vertices_, sizeof(Vertex), kAttributes, &to.indices_);
}

gl::ShaderFlags GpuScene::materialFlags(bool masked) const {
  return {{"DIFFUSE_TEXTURES", features_.diffuseTextures},
          {"ALPHA_MASK", masked},
          {"EMISSION_TEXTURES", features_.emissionTextures},
          {"EMITTERS", features_.emission},
          {"NORMAL_MAPS", features_.normalMaps},
          {"METAL_MAPS", features_.metalMaps},
          {"SPECULAR", features_.specular}};
}

void GpuScene::bindSurface(const gl::Program& program, const Surface& surface, bool isotropic) const {
  program.set("materialDiffuse", surface.diffuse);
  if (features_.specular) {
    program.set("materialSpecular", surface.specular);
    program.set("materialAlpha", surface.alpha);
  }
  if (features_.emission) program.set("materialEmission", surface.emission);
  const auto bind = [&](int texture, GLuint unit) {
    (texture >= 0 ? textures_[static_cast<std::size_t>(texture)] : *white_).bind(unit);
  };
  if (features_.diffuseTextures) bind(surface.diffuseTexture, UNIT_DIFFUSE);
  if (isotropic && surface.isotropic) surface.isotropic->bind(UNIT_DIFFUSE);
  if (features_.emissionTextures) bind(surface.emissionTexture, UNIT_EMISSION_MAP);
  if (features_.normalMaps) {
    program.set("materialNormalScale", surface.normalScale);
    bind(surface.normalTexture, UNIT_NORMAL_MAP);
  }
  if (features_.metalMaps) {
    program.set("materialMetallic", surface.metallic);
    program.set("materialRoughness", surface.roughness);
    bind(surface.metalTexture, UNIT_METAL_MAP);
  }
  if (surface.masked) textures_[static_cast<std::size_t>(surface.maskTexture)].bind(UNIT_MASK);
}

void GpuScene::drawRange(const Draw& draw) const { gl::drawIndexedTriangles(draw.firstIndex, draw.indexCount); }

void GpuScene::draw(const SurfacePrograms& programs, const View& view, const Selection* only) const {
  const Selection& drawn = only ? *only : all_;
  drawn.vertexArray_.bind();
  if (coats_) coats_->bind(UNIT_COAT);
  const bool isotropic = !view.anisotropic && !isotropic_.empty();
  for (const bool masked : {false, true}) {
    const std::vector<Draw>& meshes = masked ? drawn.masked_ : drawn.opaque_;
    if (meshes.empty()) continue;
    std::vector<std::pair<float, const Draw*>> order;
    for (const Draw& draw : meshes) {
      if (view.clipFromWorld && outsideFrustum(*view.clipFromWorld, draw.centre, draw.halfExtent)) continue;
      float distance = 0.0f;
      if (view.viewPoint) {
        const glm::vec3 away = glm::max(glm::abs(*view.viewPoint - draw.centre) - draw.halfExtent, glm::vec3(0.0f));
        distance = glm::dot(away, away);
      }
      order.emplace_back(distance, &draw);
    }
    std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    const gl::Program& program = masked ? *programs.masked : *programs.opaque;
    program.use();
    int bound = -1;
    for (const auto& [distance, draw] : order) {
      if (draw->surface != bound) bindSurface(program, surfaces_[static_cast<std::size_t>(draw->surface)], isotropic);
      bound = draw->surface;
      drawRange(*draw);
    }
  }
  if (isotropic) gl::Sampler::unbind(UNIT_DIFFUSE);
}

void GpuScene::drawDepth(const SurfacePrograms& programs, Meshes meshes) const {
  const auto isDrawn = [&](const Draw& draw) {
    return meshes == Meshes::all || draw.moves == (meshes == Meshes::moving);
  };
  all_.vertexArray_.bind();
  if (!all_.opaque_.empty()) programs.opaque->use();
  // Meshes that follow one another in the index buffer are one call.
  std::uint32_t first = 0, count = 0;
  for (const Draw& draw : all_.opaque_) {
    if (!isDrawn(draw)) continue;
    if (draw.firstIndex != first + count) {
      if (count > 0) gl::drawIndexedTriangles(first, count);
      first = draw.firstIndex, count = 0;
    }
    count += draw.indexCount;
  }
  if (count > 0) gl::drawIndexedTriangles(first, count);
  if (!all_.masked_.empty()) programs.masked->use();
  for (const Draw& draw : all_.masked_) {
    if (!isDrawn(draw)) continue;
    textures_[static_cast<std::size_t>(surfaces_[static_cast<std::size_t>(draw.surface)].maskTexture)].bind(UNIT_MASK);
    drawRange(draw);
  }
}

bool GpuScene::isSelectionWorthwhile(int size) const {
  return isSoftware_ && scene_->indices.size() / 3 > static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
}

GpuScene::Selection GpuScene::covering(const glm::mat4& clipFromWorld, int size) const {
  // Vertices in texels; centres of texels are whole numbers. GPUs round positions to fractions of a texel, at least to
  // 1/16 (GL_SUBPIXEL_BITS), and sums may be rounded in another order here.
  const glm::mat4 rows = glm::transpose(clipFromWorld);
  const float half = 0.5f * static_cast<float>(size);
  const glm::vec4 toX = half * rows[0], toY = half * rows[1];
  const glm::vec3 farthest(glm::max(glm::abs(scene_->bounds.min), glm::abs(scene_->bounds.max)));
  const auto magnitude = [&](const glm::vec4& row) {
    return glm::dot(glm::abs(glm::vec3(row)), farthest) + std::abs(row.w);
  };
  constexpr float kRoundings = 16.0f;
  const float margin = 1.0f / 16.0f + kRoundings * std::numeric_limits<float>::epsilon() *
                                          (std::max(magnitude(toX), magnitude(toY)) + half);
  std::vector<glm::vec2> places(scene_->vertices.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const glm::vec4 position(scene_->vertices[i].position, 1.0f);
    places[i] = glm::vec2(glm::dot(toX, position), glm::dot(toY, position)) + (half - 0.5f);
  }
  const float last = static_cast<float>(size - 1);
  const auto coversCentre = [&](float a, float b, float c) {
    const float low = std::max(std::min({a, b, c}) - margin, 0.0f), high = std::min(std::max({a, b, c}) + margin, last);
    return std::floor(high) >= low;
  };

  Selection selection;
  std::vector<std::uint32_t> kept;
  kept.reserve(scene_->indices.size() / 2);
  for (const bool masked : {false, true})
    for (const Draw& draw : masked ? all_.masked_ : all_.opaque_) {
      Draw part = draw;
      part.firstIndex = static_cast<std::uint32_t>(kept.size());
      for (std::uint32_t i = draw.firstInScene; i < draw.firstInScene + draw.indexCount; i += 3) {
        const std::uint32_t* corners = &scene_->indices[i];
        const glm::vec2 &a = places[corners[0]], &b = places[corners[1]], &c = places[corners[2]];
        if (coversCentre(a.x, b.x, c.x) && coversCentre(a.y, b.y, c.y)) kept.insert(kept.end(), corners, corners + 3);
      }
      part.indexCount = static_cast<std::uint32_t>(kept.size()) - part.firstIndex;
      if (part.indexCount > 0) (masked ? selection.masked_ : selection.opaque_).push_back(part);
    }
  if (!kept.empty()) uploadIndices("scene for a map", kept, selection);
  return selection;
}

std::size_t GpuScene::gpuBytes() const {
  std::size_t bytes = vertices_.bytes() + before_.bytes() + all_.gpuBytes();
  for (const std::optional<gl::Texture>* texture : {&white_, &coats_})
    if (*texture) bytes += (*texture)->bytes();
  for (const gl::Texture& texture : textures_) bytes += texture.bytes();
  return bytes;
}

}  // namespace lucerna
