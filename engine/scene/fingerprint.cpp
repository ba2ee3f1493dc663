#include "scene/fingerprint.hpp"

namespace lucerna {

namespace {

// Adding a field to one of these changes its size: then add the field below (or here, if light does not depend on it)
// and correct the number.
#if defined(__x86_64__) && defined(__GLIBCXX__)
static_assert(sizeof(Material) == 160, "add what is new to the fingerprint");
static_assert(sizeof(Medium) == 184, "add what is new to the fingerprint");
static_assert(sizeof(Environment) == 64, "add what is new to the fingerprint");
#endif

void add(Hash& h, const Material& m) {
  h.add(static_cast<int>(m.bsdf));
  h.add(m.roughness), h.add(m.ior), h.add(m.interior), h.add(m.priority);
  h.add(m.diffuse), h.add(m.specular), h.add(m.emission);
  h.add(m.opacity), h.add(m.diffuseTexture), h.add(m.alphaTexture), h.add(m.alphaMasked);
  if (m.emissionTexture >= 0) h.add(m.emissionTexture), h.add(m.emissionScale);
  if (m.normalTexture >= 0) h.add(m.normalTexture), h.add(m.normalScale);
  if (m.metalMap)
    h.add(m.metalMap->base), h.add(m.metalMap->metallic), h.add(m.metalMap->roughness), h.add(m.metalMap->texture);
}

void add(Hash& h, const Image& image) {
  h.add(image.width), h.add(image.height);
  for (const glm::vec3& p : image.pixels) h.add(p);
}

void add(Hash& h, const Medium& m) {
  h.add(m.scattering), h.add(m.absorption), h.add(m.anisotropy), h.add(m.emission);
  h.add(static_cast<int>(m.phase));
  h.add(m.grid.has_value());
  if (!m.grid) return;
  h.add(m.grid->size);
  h.bytes(m.grid->density.data(), m.grid->density.size() * sizeof(float));
  h.add(m.grid->min), h.add(m.grid->max);
}

}  // namespace

void addSurfaces(Hash& h, const Scene& scene) {
  for (const Vertex& v : scene.vertices) h.add(v.position), h.add(v.texCoord), h.add(v.normal);
  h.bytes(scene.indices.data(), scene.indices.size() * sizeof scene.indices[0]);
  for (const Mesh& m : scene.meshes) h.add(m.firstIndex), h.add(m.indexCount), h.add(m.material);
  for (const Material& m : scene.materials) add(h, m);
  for (const Texture& t : scene.textures) {
    h.add(t.bitmap.width), h.add(t.bitmap.height), h.add(t.bitmap.hasAlpha);
    h.bytes(t.bitmap.rgba.data(), t.bitmap.rgba.size());
    if (!t.wraps.repeat()) h.add(static_cast<int>(t.wraps.u)), h.add(static_cast<int>(t.wraps.v));
  }
}

void addScene(Hash& h, const Scene& scene) {
  addSurfaces(h, scene);
  h.add(scene.sun.has_value());
  if (scene.sun) h.add(scene.sun->direction), h.add(scene.sun->irradiance), h.add(scene.sun->angularDiameter);
  for (const SpotLight& l : scene.spots)
    h.add(l.position), h.add(l.direction), h.add(l.intensity), h.add(l.innerAngle), h.add(l.outerAngle),
        h.add(l.radius);
  for (const PointLight& l : scene.points) h.add(l.position), h.add(l.intensity), h.add(l.radius);
  for (const Medium& m : scene.media) add(h, m);
  h.add(scene.cameraMedium);
  h.add(scene.environment.has_value());
  if (scene.environment) {
    h.add(scene.environment->radiance), h.add(scene.environment->rotation),
        h.add(scene.environment->picture.has_value());
    if (scene.environment->picture) add(h, *scene.environment->picture);
  }
  h.add(scene.background);
}

void addCamera(Hash& h, const Camera& camera) {
  h.add(camera.position), h.add(camera.direction), h.add(camera.up);
  h.add(camera.verticalFov);
  if (camera.isOrthographic()) h.add(camera.orthographicHeight);
}

}  // namespace lucerna
