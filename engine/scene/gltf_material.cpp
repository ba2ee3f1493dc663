// KHR_texture_transform goes into the texture coordinates, alphaCutoff over baseColorFactor's alpha into the mask,
// KHR_materials_emissive_strength into the emission, KHR_materials_volume into a medium. Unsupported properties give
// one warning per material. Occlusion textures are not read: techniques compute that light themselves.
// Metallic-roughness is read texel by texel (MetalMap).
#include "scene/gltf_material.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace lucerna {

namespace {

glm::dvec2 pairOf(const Value& v) {
  if (!v.json.is_array() || v.json.size() != 2) v.fail("an array of 2 numbers");
  return {v.at(std::size_t{0}).number(), v.at(std::size_t{1}).number()};
}

unsigned texCoordOf(const Value& v) {
  if (!v.json.is_number_unsigned() || v.json.get<std::size_t>() > 1000) v.fail("a set of texture coordinates");
  return v.json.get<unsigned>();
}

TextureTransform transformOf(const Value& texture) {
  TextureTransform result;
  if (texture.has("texCoord")) result.texCoord = texCoordOf(texture.at("texCoord"));
  const std::optional<Value> given = GltfFile::extension(texture, "KHR_texture_transform");
  if (!given) return result;
  if (given->has("offset")) result.offset = pairOf(given->at("offset"));
  if (given->has("scale")) result.scale = pairOf(given->at("scale"));
  if (given->has("rotation")) result.rotation = given->at("rotation").number();
  if (given->has("texCoord")) result.texCoord = texCoordOf(given->at("texCoord"));
  return result;
}

/// [GLTF2, 5.26]; its values are OpenGL's.
TextureWrap wrapOf(const Value& sampler, const char* key) {
  if (!sampler.has(key)) return TextureWrap::repeat;
  const Value wrap = sampler.at(key);
  if (wrap.json == 10497) return TextureWrap::repeat;
  if (wrap.json == 33071) return TextureWrap::edge;
  if (wrap.json == 33648) return TextureWrap::mirror;
  wrap.fail("10497 (REPEAT), 33071 (CLAMP_TO_EDGE) or 33648 (MIRRORED_REPEAT)");
}

TextureWraps wrapsOf(const GltfFile& file, const Value& texture) {
  if (!texture.has("sampler")) return {};
  const Value sampler = file.at("samplers", file.indexOf(texture.at("sampler"), "samplers"));
  if (!sampler.json.is_object()) sampler.fail("an object {...}");
  return {wrapOf(sampler, "wrapS"), wrapOf(sampler, "wrapT")};
}

/// Pictures without a file of their own. A URI never begins with a space.
std::string embeddedName(std::string_view array, std::size_t index) { return fmt::format(" {}[{}]", array, index); }

/// What a TextureLoader calls the picture of a texture.
std::string pictureOf(const GltfFile& file, std::size_t index) {
  const Value texture = file.at("textures", index);
  if (!texture.json.is_object()) texture.fail("an object {...}");
  if (!texture.has("source")) return embeddedName("textures", index);
  const std::size_t source = file.indexOf(texture.at("source"), "images");
  const Value image = file.at("images", source);
  if (!image.json.is_object()) image.fail("an object {...}");
  if (!image.has("uri") || image.at("uri").text().starts_with("data:")) return embeddedName("images", source);
  return fileNameOf(image.at("uri"));
}

glm::vec3 colourIn(const Value& v) {
  if (!v.json.is_array() || v.json.size() < 3) v.fail("an array of 3 numbers");
  glm::vec3 colour;
  for (int c = 0; c < 3; ++c) colour[c] = static_cast<float>(std::max(v.at(static_cast<std::size_t>(c)).number(), 0.0));
  return colour;
}

/// Reads the members of one material.
class MaterialReader {
 public:
  MaterialReader(const GltfFile& file, const Value& material) : file_(file), material_(material) {}

  GltfMaterial read() {
    if (!material_.json.is_object()) material_.fail("an object {...}");
    if (material_.has("name")) result_.name = material_.at("name").text();
    readMetallicRoughness();
    readSpecularGlossiness();
    readMaps();
    readAlpha();
    readExtensions();
    return result_;
  }

 private:
  float fraction(const Value& object, const char* key, float otherwise) const {
    if (!object.has(key)) return otherwise;
    return static_cast<float>(std::clamp(object.at(key).number(), 0.0, 1.0));
  }

  /// `what`: the picture, in messages. One set of texture coordinates serves all pictures.
  PictureUse picture(const Value& object, const char* key, const char* what) {
    if (!object.has(key)) return {};
    const Value texture = object.at(key);
    if (!texture.json.is_object() || !texture.has("index")) texture.fail("an object with an index");
    const std::size_t index = file_.indexOf(texture.at("index"), "textures");
    const TextureTransform transform = transformOf(texture);
    if (!result_.transform) result_.transform = transform;
    else if (!(transform == *result_.transform))
      result_.lacks(fmt::format("the {} texture lies as the first one does", what));
    return {pictureOf(file_, index), wrapsOf(file_, file_.at("textures", index))};
  }

  void readBase(const Value& object, const char* factor, const char* texture) {
    if (object.has(factor)) {
      const Value base = object.at(factor);
      if (!base.json.is_array() || base.json.size() != 4) base.fail("an array of 4 numbers");
      result_.base = glm::min(colourIn(base), glm::vec3(1.0f));
      result_.baseAlpha = std::clamp(base.at(std::size_t{3}).number(), 0.0, 1.0);
    }
    result_.basePicture = picture(object, texture, "base colour's");
  }

  void readMetallicRoughness() {
    if (!material_.has("pbrMetallicRoughness")) return;
    const Value metal = material_.at("pbrMetallicRoughness");
    if (!metal.json.is_object()) metal.fail("an object {...}");
    if (GltfFile::extension(material_, "KHR_materials_pbrSpecularGlossiness")) return;
    readBase(metal, "baseColorFactor", "baseColorTexture");
    result_.metallic = fraction(metal, "metallicFactor", 1.0f);
    result_.roughness = fraction(metal, "roughnessFactor", 1.0f);
    result_.metalPicture = picture(metal, "metallicRoughnessTexture", "metallic-roughness");
  }

  void readSpecularGlossiness() {
    const std::optional<Value> given = GltfFile::extension(material_, "KHR_materials_pbrSpecularGlossiness");
    if (!given) return;
    readBase(*given, "diffuseFactor", "diffuseTexture");
    result_.specular = given->has("specularFactor") ? glm::min(colourIn(given->at("specularFactor")), glm::vec3(1.0f))
                                                    : glm::vec3(1.0f);
    result_.metallic = 0.0f;
    result_.roughness = 1.0f - fraction(*given, "glossinessFactor", 1.0f);
    if (given->has("specularGlossinessTexture")) result_.lacks("specular and glossiness without their texture");
  }

  void readMaps() {
    result_.normalPicture = picture(material_, "normalTexture", "normal");
    if (!result_.normalPicture.empty() && material_.at("normalTexture").has("scale"))
      result_.normalScale = static_cast<float>(
          material_.at("normalTexture").at("scale").numberBetween(-1e3, 1e3, "a number from -1000 to 1000"));
    if (material_.has("emissiveFactor")) result_.emissive = colourIn(material_.at("emissiveFactor"));
    result_.emissivePicture = picture(material_, "emissiveTexture", "emissive");
  }

  void readAlpha() {
    if (material_.has("alphaCutoff"))
      result_.alphaCutoff = material_.at("alphaCutoff").numberBetween(0.0, 1e6, "a number, 0 or more");
    if (!material_.has("alphaMode")) return;
    const std::string mode = material_.at("alphaMode").text();
    if (mode != "OPAQUE" && mode != "MASK" && mode != "BLEND") material_.at("alphaMode").fail("OPAQUE, MASK or BLEND");
    result_.alpha = mode == "MASK"    ? GltfMaterial::Alpha::mask
                    : mode == "BLEND" ? GltfMaterial::Alpha::blend
                                      : GltfMaterial::Alpha::opaque;
  }

  /// Unknown ones are reported.
  void readExtensions() {
    if (!material_.has("extensions")) return;
    const Value extensions = material_.at("extensions");
    if (!extensions.json.is_object()) extensions.fail("an object {...}");
    for (const auto& member : extensions.json.items()) {
      const std::string& name = member.key();
      const Value extension = extensions.at(name);
      if (!extension.json.is_object()) extension.fail("an object {...}");
      if (name == "KHR_materials_emissive_strength") {
        if (extension.has("emissiveStrength"))
          result_.emissiveStrength =
              static_cast<float>(extension.at("emissiveStrength").numberBetween(0.0, 1e30, "a number, 0 or more"));
      } else if (name == "KHR_materials_ior") {
        readIor(extension);
      } else if (name == "KHR_materials_volume") {
        readVolume(extension);
      } else if (name == "KHR_materials_transmission") {
        if (extension.has("transmissionFactor"))
          result_.transmission =
              static_cast<float>(extension.at("transmissionFactor").numberBetween(0.0, 1.0, "a number from 0 to 1"));
        if (extension.has("transmissionTexture")) result_.lacks("transmission without its texture");
      } else if (name != "KHR_materials_pbrSpecularGlossiness") {
        result_.lacks("no " + name);
      }
    }
  }

  void readIor(const Value& extension) {
    if (!extension.has("ior")) return;
    const double ior = extension.at("ior").number();
    if (ior == 0.0) result_.lacks("ior 1.5 in place of 0");  // Fresnel's reflection is 1 there
    else result_.ior = static_cast<float>(extension.at("ior").numberBetween(1.0, 10.0, "0, or a number from 1 to 10"));
  }

  void readVolume(const Value& extension) {
    if (extension.has("thicknessFactor"))
      result_.thickness = extension.at("thicknessFactor").numberBetween(0.0, 1e30, "a number, 0 or more");
    if (extension.has("thicknessTexture")) result_.lacks("thickness without its texture");
    if (!extension.has("attenuationDistance")) return;  // no absorption
    const double distance = extension.at("attenuationDistance").positiveNumber();
    if (!extension.has("attenuationColor")) return;
    // Light is reduced to `colour` after `distance`. Black would be infinitely dense; a millionth is as good as black.
    const glm::dvec3 colour =
        glm::max(extension.at("attenuationColor").vectorBetween(0.0, 1.0, "an array of 3 numbers from 0 to 1"),
                 glm::dvec3(1e-6));
    result_.absorption = glm::vec3(-glm::log(colour) / distance);
  }

  const GltfFile& file_;
  Value material_;
  GltfMaterial result_;
};

/// Alpha is never blended: masks are cut at the cut-off. Where a picture's alpha asks for blending, it is cut at one
/// half; without one, what is partly transparent is drawn opaque.
void setMask(Material& material, TextureLoader& textures, GltfMaterial& gltf) {
  const bool hasAlpha = material.diffuseTexture >= 0 && textures[material.diffuseTexture].hasAlpha;
  material.alphaMasked = hasAlpha && gltf.alpha != GltfMaterial::Alpha::opaque;
  if (gltf.alpha == GltfMaterial::Alpha::blend) {
    if (gltf.baseAlpha == 0.0) material.opacity = 0.0f;
    else if (hasAlpha) gltf.lacks("not blended (BLEND) but cut out where its texture's alpha is below 0.5");
    else if (gltf.baseAlpha < 1.0)
      gltf.lacks(fmt::format("not blended (BLEND) but drawn opaque, whose alpha is {:.3g}", gltf.baseAlpha));
  }
  if (gltf.alpha != GltfMaterial::Alpha::mask) return;
  const double threshold = gltf.baseAlpha > 0.0     ? gltf.alphaCutoff / gltf.baseAlpha
                           : gltf.alphaCutoff > 0.0 ? 2.0
                                                    : 0.0;
  if (threshold > 1.0) material.opacity = 0.0f;  // cut out everywhere
  else if (threshold <= 0.0) material.alphaMasked = false;
  else if (material.alphaMasked && threshold != 0.5)
    material.diffuseTexture = textures.withThreshold(material.diffuseTexture, threshold);
}

/// Metallic-roughness, or specular-glossiness, whose two colours are those of base and coat.
void setSurface(Material& material, const GltfMaterial& gltf, const glm::vec3& tint, TextureLoader& textures) {
  const int picture = textures.optional(gltf.metalPicture);
  const glm::vec3 map = picture >= 0 ? meanValue(textures[picture]) : glm::vec3(1.0f), base = gltf.base * tint;
  setMetallicRoughness(material, base, gltf.metallic * map.z, gltf.roughness * map.y, gltf.transmission);
  if (gltf.specular) {
    material.specular = *gltf.specular;
    material.diffuse = base;
  }
  // A metal's picture is the colour of its reflection.
  if (picture >= 0 || (gltf.metallic > 0.0f && !gltf.basePicture.empty()))
    material.metalMap = {base, gltf.metallic, gltf.roughness, picture};
}

void setInterior(Material& material, Scene& scene, const GltfMaterial& gltf) {
  if (material.bsdf != Bsdf::dielectric) return;
  material.ior = gltf.ior;
  if (!(gltf.thickness > 0.0) || gltf.absorption == glm::vec3(0.0f)) return;
  Medium medium;
  medium.name = material.name;
  medium.absorption = gltf.absorption;
  material.interior = static_cast<int>(scene.media.size());
  scene.media.push_back(std::move(medium));
}

}  // namespace

glm::dvec2 TextureTransform::apply(const glm::dvec2& uv) const {
  const double c = std::cos(rotation), s = std::sin(rotation);
  const glm::dvec2 scaled = scale * uv;
  return offset + glm::dvec2(c * scaled.x + s * scaled.y, c * scaled.y - s * scaled.x);
}

void GltfMaterial::lacks(std::string_view what) {
  if (notDone.find(what) == std::string::npos) notDone += fmt::format("{}{}", notDone.empty() ? "" : ", ", what);
}

GltfMaterial gltfMaterial(const GltfFile& file, std::optional<std::size_t> index) {
  return index ? MaterialReader(file, file.at("materials", *index)).read() : GltfMaterial{};
}

TextureLoader::Embedded gltfPictures(const GltfFile& file) {
  return [&file](const std::string& name, const std::filesystem::path& label) -> std::optional<Bitmap> {
    const std::size_t bracket = name.find('[');
    std::size_t index = 0;
    if (!name.starts_with(' ') || bracket == std::string::npos ||
        std::from_chars(&name[bracket] + 1, name.data() + name.size(), index).ec != std::errc())
      return std::nullopt;
    if (name == embeddedName("textures", index) && index < file.count("textures")) {
      std::string needs;
      if (const Value texture = file.at("textures", index); texture.has("extensions"))
        for (const auto& extension : texture.at("extensions").json.items())
          needs += fmt::format("{}{}", needs.empty() ? ", only a picture of " : ", ", extension.key());
      throwBadInput("{}: no source{}", label.string(), needs);
    }
    if (name != embeddedName("images", index) || index >= file.count("images")) return std::nullopt;
    const Value image = file.at("images", index);
    if (image.has("uri")) {
      const std::optional<std::vector<std::uint8_t>> data = dataOf(image.at("uri"));
      return data ? std::optional(decodeBitmap(*data, label)) : std::nullopt;
    }
    if (!image.has("bufferView")) image.fail("an object with a uri or a bufferView");
    return decodeBitmap(file.bytesOfView(file.indexOf(image.at("bufferView"), "bufferViews")), label);
  };
}

Material materialOf(GltfMaterial& gltf, const glm::vec3& tint, TextureLoader& textures, Scene& scene) {
  Material material;
  material.name = gltf.name;
  setSurface(material, gltf, tint, textures);
  setInterior(material, scene, gltf);
  if (gltf.emissive != glm::vec3(0.0f))
    setEmission(material, gltf.emissive * gltf.emissiveStrength, textures.optional(gltf.emissivePicture), textures);
  material.normalTexture = textures.optional(gltf.normalPicture);
  material.normalScale = gltf.normalScale;
  material.diffuseTexture = textures.albedo(gltf.basePicture);
  setMask(material, textures, gltf);
  return material;
}

void setFactors(Material& material, const GltfMaterial& gltf, const glm::vec3& tint, const glm::vec3& metalMean,
                const glm::vec3& emissiveMean) {
  const glm::vec3 base = gltf.base * tint;
  setMetallicRoughness(material, base, gltf.metallic * metalMean.z, gltf.roughness * metalMean.y, 0.0f);
  if (gltf.specular) {
    material.specular = *gltf.specular;
    material.diffuse = base;
  }
  if (material.metalMap) material.metalMap = {base, gltf.metallic, gltf.roughness, material.metalMap->texture};
  material.emissionScale = gltf.emissive * gltf.emissiveStrength;
  material.emission = material.emissionScale * emissiveMean;
}

}  // namespace lucerna
