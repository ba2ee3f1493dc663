#include "scene/mtl_file.hpp"

#include "base/log.hpp"
#include "scene/coat.hpp"
#include "scene/polygon_mesh.hpp"
#include "scene/text_lines.hpp"
#include "scene/texture_mean.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lucerna {

namespace {

/// Keys without an effect here, or in any physically based renderer: ambient light, its pictures; hints for filters.
constexpr std::string_view kSilent[] = {"ka", "map_ka", "sharpness", "map_aat"};

std::string_view withoutQuotes(std::string_view name) {
  const bool quoted = name.size() >= 2 && name.front() == name.back() && (name.front() == '"' || name.front() == '\'');
  return quoted ? name.substr(1, name.size() - 2) : name;
}

class MtlReader {
 public:
  MtlReader(std::string_view text, std::set<std::string>& ignored) : lines_(text, true), ignored_(ignored) {}

  std::vector<MtlMaterial> run() {
    while (lines_.next()) {
      const std::string_view word = lines_.word();
      if (word.empty() || word[0] == '#') continue;
      const std::string key = lowerCase(word);
      if (key == "newmtl") materials_.emplace_back().name = withoutQuotes(lines_.rest());
      else if (!materials_.empty()) value(word, key, materials_.back());
    }
    return std::move(materials_);
  }

 private:
  void value(std::string_view word, const std::string& key, MtlMaterial& m) {
    if (key == "kd") colour(word, m.diffuse);
    else if (key == "ks") colour(word, m.specular);
    else if (key == "ke") colour(word, m.emission);
    else if (key == "ns") number(word, m.shininess);
    else if (key == "ni") number(word, m.ior);
    else if (key == "pm") number(word, m.metallic);
    else if (key == "pr") number(word, m.roughness);
    else if (key == "d") number(word, m.opacity);
    else if (key == "tr") {
      if (number(word, m.opacity)) *m.opacity = 1.0f - *m.opacity;
    } else if (key == "illum") {
      std::optional<float> model;
      if (number(word, model)) m.illum = static_cast<int>(std::clamp(*model, -1.0f, 100.0f));
    } else if (key == "map_kd") picture(word, m.diffuseMap);
    else if (key == "map_ke") picture(word, m.emissionMap);
    else if (key == "map_d") picture(word, m.opacityMap);
    else if (key == "norm" || key == "map_norm" || key == "map_kn") picture(word, m.normalMap);
    else if (key == "bump" || key == "map_bump") picture(word, m.bumpMap);
    else if (key == "map_pm") picture(word, m.metallicMap);
    else if (key == "map_pr") picture(word, m.roughnessMap);
    else if (std::find(std::begin(kSilent), std::end(kSilent), key) == std::end(kSilent)) other(word, key);
  }

  /// Keys that are not known. Those of numbers that change nothing (0, of Tf 1) are not worth a warning.
  void other(std::string_view word, const std::string& key) {
    const double neutral = key == "tf" ? 1.0 : 0.0;
    bool numbers = false;
    for (std::string_view text = lines_.word(); !text.empty() && text[0] != '#'; text = lines_.word()) {
      const std::optional<double> read = numberIn(text);
      if (!read || *read != neutral) return ignore(word);
      numbers = true;
    }
    if (!numbers) ignore(word);
  }

  void ignore(std::string_view what) { ignored_.emplace(what.substr(0, 40)); }

  /// "r g b"; missing numbers are the first one.
  void colour(std::string_view word, std::optional<glm::vec3>& to) {
    glm::vec3 read(0.0f);
    int count = 0;
    for (std::string_view text = lines_.word(); count < 3 && !text.empty() && text[0] != '#'; text = lines_.word()) {
      const std::optional<double> channel = numberIn(text);
      if (!channel) return ignore(fmt::format("{} {}", word, text));  // spectral, xyz
      read[count++] = static_cast<float>(*channel);
    }
    if (count == 0) return ignore(word);
    if (count == 2) ignore(fmt::format("{} {} {} (of two numbers)", word, read[0], read[1]));
    for (; count < 3; ++count) read[count] = read[0];
    to = read;
  }

  bool number(std::string_view word, std::optional<float>& to) {
    std::string_view text = lines_.word();
    if (text == "-halo") {
      ignore("-halo");
      text = lines_.word();
    }
    const std::optional<double> read = numberIn(text);
    if (read) to = static_cast<float>(*read);
    else ignore(fmt::format("{} {}", word, text));
    return read.has_value();
  }

  struct Option {
    std::string_view name;
    int least, most;  ///< values; those beyond the least are numbers
  };

  static const Option* optionOf(std::string_view word) {
    static constexpr Option kOptions[] = {{"-s", 1, 3},     {"-o", 1, 3},         {"-t", 1, 3},       {"-mm", 2, 2},
                                          {"-bm", 1, 1},    {"-clamp", 1, 1},     {"-blendu", 1, 1},  {"-blendv", 1, 1},
                                          {"-boost", 1, 1}, {"-texres", 1, 1},    {"-imfchan", 1, 1}, {"-type", 1, 1},
                                          {"-cc", 1, 1},    {"-colorspace", 1, 1}};
    const auto* const found = std::find_if(std::begin(kOptions), std::end(kOptions),
                                           [&](const Option& option) { return option.name == word; });
    return found == std::end(kOptions) ? nullptr : found;
  }

  /// Options, the name, which may contain blanks, and options again, as some exporters write them.
  void picture(std::string_view key, MtlPicture& to) {
    MtlPicture read;
    std::vector<std::string_view> words;
    const std::string_view line = lines_.rest();
    for (TextLines text(line); words.empty() && text.next();)
      for (std::string_view word = text.word(); !word.empty(); word = text.word()) words.push_back(word);
    std::string_view name;
    for (std::size_t i = 0; i < words.size();) {
      const Option* const option = optionOf(lowerCase(words[i]));
      if (!option) {
        const std::string_view word = words[i++];
        if (word[0] == '#' && name.find('.') != std::string_view::npos) break;  // a comment
        const char* const begin = name.empty() ? word.data() : name.data();
        name = {begin, static_cast<std::size_t>(word.data() + word.size() - begin)};
        continue;
      }
      ++i;
      std::vector<std::string_view> values;
      while (i < words.size() && static_cast<int>(values.size()) < option->most &&
             (static_cast<int>(values.size()) < option->least || numberIn(words[i])))
        values.push_back(words[i++]);
      apply(key, *option, values, read);
    }
    read.file = withoutQuotes(name);
    if (read.file.empty()) ignore(key);
    else to = std::move(read);
  }

  void apply(std::string_view key, const Option& option, const std::vector<std::string_view>& values, MtlPicture& to) {
    const auto at = [&](std::size_t i, double fallback) {
      return i < values.size() ? numberIn(values[i]).value_or(fallback) : fallback;
    };
    const std::string first = values.empty() ? std::string() : lowerCase(values[0]);
    bool done = true;
    if (option.name == "-s") to.scale = {at(0, 1.0), at(1, 1.0)};
    else if (option.name == "-o") to.offset = {at(0, 0.0), at(1, 0.0)};
    else if (option.name == "-bm") to.multiplier = static_cast<float>(at(0, 1.0));
    else if (option.name == "-clamp") to.clamped = first == "on";
    else if (option.name == "-mm") done = at(0, 0.0) == 0.0 && at(1, 1.0) == 1.0;
    else if (option.name == "-t") done = at(0, 0.0) == 0.0 && at(1, 0.0) == 0.0 && at(2, 0.0) == 0.0;
    else if (option.name == "-imfchan") done = first == "m" || first == "l" || first == "r" || first == "rgb";
    else if (option.name == "-colorspace") {
      const bool colours = lowerCase(key) == "map_kd" || lowerCase(key) == "map_ke";
      done = colours == (first == "srgb" || first == "auto");
    } else if (option.name == "-cc") done = first != "on";
    if (!done) ignore(fmt::format("{} {}{}{}", key, option.name, values.empty() ? "" : " ", fmt::join(values, " ")));
  }

  TextLines lines_;
  std::set<std::string>& ignored_;
  std::vector<MtlMaterial> materials_;
};

/// Kd, Ks, Ns, Pm, Pr, Ni, illum and d.
Material factorsOf(const MtlMaterial& mtl, TextureLoader& textures, std::set<std::string>& ignored) {
  const auto clamped = [&](const char* key, const std::optional<glm::vec3>& given, float highest,
                           const glm::vec3& fallback) {
    if (!given) return fallback;
    glm::vec3 value;
    for (int c = 0; c < 3; ++c) value[c] = clampedNumber((*given)[c], 0.0f, highest, 0.0f);
    constexpr float kRounding = 1e-3f;
    const glm::vec3 changed = glm::abs(value - *given);
    if (!(std::max({changed.x, changed.y, changed.z}) <= kRounding) || changed != changed)
      ignored.insert(fmt::format("material '{}': {} {} {} {}, which counts as {} {} {}", mtl.name, key, given->x,
                                 given->y, given->z, value.x, value.y, value.z));
    return value;
  };
  Material m;
  m.name = mtl.name;
  m.diffuse = clamped("Kd", mtl.diffuse, 1.0f, glm::vec3(mtl.diffuseMap.file.empty() ? kDefaultAlbedo : 1.0f));
  m.specular = clamped("Ks", mtl.specular, 1.0f, glm::vec3(0.0f));
  m.emission = clamped("Ke", mtl.emission, std::numeric_limits<float>::max(),
                       glm::vec3(mtl.emissionMap.file.empty() ? 0.0f : 1.0f));
  const bool metalMap = !mtl.metallicMap.file.empty(), roughMap = !mtl.roughnessMap.file.empty();
  if (mtl.metallic || mtl.roughness || metalMap || roughMap) {  // pictures count by their mean
    const float metallic = clampedNumber(mtl.metallic.value_or(metalMap ? 1.0f : 0.0f), 0.0f, 1.0f, 0.0f) *
                           textures.mean(mtl.metallicMap.file).z;
    const float roughness =
        clampedNumber(mtl.roughness.value_or(1.0f), 0.0f, 1.0f, 1.0f) * textures.mean(mtl.roughnessMap.file).y;
    const glm::vec3 base = m.diffuse;
    m.diffuse = base * (1.0f - metallic);
    m.specular = glm::mix(glm::vec3(0.04f), base, metallic);
    m.roughness = roughness * roughness;
  } else {
    if (mtl.illum == 0 || mtl.illum == 1) m.specular = glm::vec3(0.0f);  // models without a highlight
    m.diffuse = baseUnderCoat(m.diffuse, m.specular);
    m.roughness = alphaOfExponent(clampedNumber(mtl.shininess.value_or(1.0f), 0.0f, 1e6f, 1.0f));
  }
  const float ior = mtl.ior.value_or(0.0f);
  if (mtl.illum == 5 && m.specular != glm::vec3(0.0f)) m.bsdf = Bsdf::mirror;
  if ((mtl.illum == 4 || mtl.illum == 6 || mtl.illum == 7 || mtl.illum == 9) && std::isfinite(ior) && ior >= 1.0f) {
    m.bsdf = Bsdf::dielectric;
    m.ior = ior;
  }
  if (m.bsdf != Bsdf::diffuse && !mtl.roughness) m.roughness = 0.0f;
  m.opacity = clampedNumber(mtl.opacity.value_or(1.0f), 0.0f, 1.0f, 1.0f);
  return m;
}

/// Whether a picture holds normals: nine in ten texels are unit vectors with z above 0. Heights are grey.
bool holdsNormals(const Bitmap& bitmap) {
  std::size_t units = 0;
  for (std::size_t i = 0; i < bitmap.rgba.size(); i += 4) {
    const std::uint8_t* const p = &bitmap.rgba[i];
    const glm::vec3 n = glm::vec3(p[0], p[1], p[2]) / 127.5f - 1.0f;
    units += n.z > 0.0f && std::abs(glm::length(n) - 1.0f) < 0.15f && (p[0] != p[1] || p[0] != p[2]);
  }
  return 10 * units >= 9 * (bitmap.rgba.size() / 4);
}

}  // namespace

std::vector<MtlMaterial> readMtl(std::string_view text, std::set<std::string>& ignored) {
  return MtlReader(text, ignored).run();
}

const MtlPicture& leadingPicture(const MtlMaterial& m) {
  for (const MtlPicture* picture : {&m.diffuseMap, &m.opacityMap, &m.emissionMap, &m.normalMap, &m.bumpMap})
    if (!picture->file.empty()) return *picture;
  return m.diffuseMap;
}

/// Whether a picture's alpha cuts something out: nearly all of it is clear or opaque, and there is some of each. Gloss
/// and heights are neither.
bool cutsOut(const Bitmap& bitmap) {
  const std::size_t texels = bitmap.rgba.size() / 4;
  std::size_t clear = 0, opaque = 0;
  for (std::size_t i = 3; i < bitmap.rgba.size(); i += 4) {
    clear += bitmap.rgba[i] < 16;
    opaque += bitmap.rgba[i] > 239;
  }
  return clear > 0 && opaque > 0 && 10 * (clear + opaque) >= 9 * texels;
}

Material materialOf(const MtlMaterial& mtl, TextureLoader& textures, std::set<std::string>& ignored) {
  Material m = factorsOf(mtl, textures, ignored);
  const std::string where = fmt::format("material '{}'", m.name);

  // Colour, opacity.
  m.diffuseTexture = textures.albedo(mtl.diffuseMap.use());
  const bool hasAlpha = m.diffuseTexture >= 0 && textures[m.diffuseTexture].hasAlpha;
  const bool ownMask = mtl.opacityMap.file == mtl.diffuseMap.file;
  if (!ownMask || (hasAlpha && mtl.opacityMap.use() != mtl.diffuseMap.use()))
    m.alphaTexture = textures.optional(mtl.opacityMap.use());
  const bool alphaIsOpacity = hasAlpha && (m.opacity < 1.0f || (ownMask && !mtl.opacityMap.file.empty()) ||
                                           (mtl.opacityMap.file.empty() && cutsOut(textures[m.diffuseTexture])));
  m.alphaMasked = m.alphaTexture >= 0 || alphaIsOpacity;
  if (hasAlpha && !m.alphaMasked) ignored.insert(where + ": its picture's alpha, which no map_d names");
  if (m.opacity == 0.0f) {
    if (!m.alphaMasked) ignored.insert(where + ": opacity 0, which counts as 1");
    m.opacity = 1.0f;
  }

  // Emission; code that treats a surface as a whole uses the picture's mean.
  if (m.emission != glm::vec3(0.0f)) {
    m.emissionScale = m.emission;
    m.emissionTexture = textures.optional(mtl.emissionMap.use());
    if (m.emissionTexture >= 0) m.emission *= glm::vec3(meanColour(textures[m.emissionTexture]));
    else if (!mtl.emission) m.emission = m.emissionScale = glm::vec3(0.0f);
  }

  // Normals.
  m.normalTexture = textures.optional(mtl.normalMap.use());
  m.normalScale = mtl.normalMap.multiplier;
  if (m.normalTexture < 0 && !mtl.bumpMap.file.empty()) {
    m.normalTexture = textures.optionalIf(mtl.bumpMap.use(), holdsNormals);
    m.normalScale = mtl.bumpMap.multiplier;
    if (m.normalTexture < 0) ignored.insert("bump (maps of heights)");
  }
  for (const MtlPicture* picture : {&mtl.diffuseMap, &mtl.opacityMap, &mtl.emissionMap, &mtl.normalMap, &mtl.bumpMap}) {
    const MtlPicture& leading = leadingPicture(mtl);
    if (!picture->file.empty() && (picture->scale != leading.scale || picture->offset != leading.offset))
      ignored.insert(fmt::format("{}: -s and -o of {}, other than those of {}", where, picture->file, leading.file));
  }
  return m;
}

}  // namespace lucerna
