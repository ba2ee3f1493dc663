// Pictures of models: each is read once, from beside the model or from inside of it.
#include "scene/model_parts.hpp"

#include "base/error.hpp"
#include "base/log.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>

namespace lucerna {

namespace fs = std::filesystem;

namespace {

Bitmap checkerBitmap() {
  constexpr int kSize = 64, kSquare = 8;
  Bitmap bitmap{kSize, kSize, std::vector<std::uint8_t>(4 * kSize * kSize, 255), false};
  for (int y = 0; y < kSize; ++y)
    for (int x = 0; x < kSize; ++x) {
      const std::uint8_t grey = (x / kSquare + y / kSquare) % 2 ? 200 : 90;
      std::fill_n(bitmap.rgba.begin() + 4 * (y * kSize + x), 3, grey);
    }
  return bitmap;
}

}  // namespace

std::string withForwardSlashes(std::string path) {
  std::replace(path.begin(), path.end(), '\\', '/');
  return path;
}

fs::path fileBeside(const fs::path& model, const std::string& name) {
  const fs::path folder = model.parent_path(), path = (folder / withForwardSlashes(name)).lexically_normal(),
                 bare = folder / path.filename();
  std::error_code error;
  if (fs::exists(path, error)) return path;
  if (fs::exists(bare, error)) return bare;
  const auto lower = [](std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
  };
  const std::string wanted = lower(path.filename().string());
  for (const fs::path& place : {path.parent_path(), folder})
    for (const auto& entry : fs::directory_iterator(place.empty() ? fs::path(".") : place, error))
      if (lower(entry.path().filename().string()) == wanted) return entry.path();
  return path;
}

glm::vec3 meanValue(const Bitmap& bitmap) {
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < bitmap.rgba.size(); i += 4)
    sum += glm::dvec3(bitmap.rgba[i], bitmap.rgba[i + 1], bitmap.rgba[i + 2]);
  return glm::vec3(sum / (255.0 * static_cast<double>(bitmap.rgba.size() / 4)));
}

int TextureLoader::albedo(const PictureUse& picture) {
  if (picture.empty()) return -1;
  const int index = load(picture);
  return index >= 0 ? index : checker();
}

int TextureLoader::optional(const PictureUse& picture) { return picture.empty() ? -1 : load(picture); }

int TextureLoader::optionalIf(const PictureUse& picture, bool (*isWanted)(const Bitmap&)) {
  if (const auto known = indices_.find(picture); known != indices_.end())
    return known->second >= 0 && isWanted((*this)[known->second]) ? known->second : -1;
  std::optional<Texture> texture = read(picture);
  if (!texture || !isWanted(texture->bitmap)) return -1;
  const int index = indices_[picture] = static_cast<int>(scene_.textures.size());
  scene_.textures.push_back(std::move(*texture));
  return index;
}

glm::vec3 TextureLoader::mean(const std::string& name) {
  if (name.empty()) return glm::vec3(1.0f);
  const std::optional<Texture> texture = read({name});
  return texture ? meanValue(texture->bitmap) : glm::vec3(1.0f);
}

int TextureLoader::withThreshold(int texture, double threshold) {
  const auto [known, isNew] = moved_.try_emplace({texture, threshold}, static_cast<int>(scene_.textures.size()));
  if (!isNew) return known->second;
  Texture copy = scene_.textures[static_cast<std::size_t>(texture)];
  const double shift = 255.0 * (0.5 - threshold);
  for (std::size_t i = 3; i < copy.bitmap.rgba.size(); i += 4)
    copy.bitmap.rgba[i] = static_cast<std::uint8_t>(std::clamp(std::lround(copy.bitmap.rgba[i] + shift), 0l, 255l));
  scene_.textures.push_back(std::move(copy));
  return known->second;
}

int TextureLoader::load(const PictureUse& picture) {
  const auto known = indices_.find(picture);
  if (known != indices_.end()) return known->second;
  int index = -1;
  if (std::optional<Texture> texture = read(picture)) {
    index = static_cast<int>(scene_.textures.size());
    scene_.textures.push_back(std::move(*texture));
  }
  indices_[picture] = index;
  return index;
}

std::optional<Texture> TextureLoader::read(const PictureUse& picture) {
  const std::string& name = picture.name;
  try {
    const fs::path label = scene_.file.string() + ":" + name;
    if (std::optional<Bitmap> embedded = embedded_(name, label))
      return Texture{label, std::move(*embedded), picture.wraps};
    const fs::path file = fileBeside(scene_.file, name);
    return Texture{file, readBitmap(file), picture.wraps};
  } catch (const Error& e) {
    if (std::find(unreadable_.begin(), unreadable_.end(), name) == unreadable_.end()) {
      unreadable_.push_back(name);
      logWarning("texture {} (using a default)", e.what());
    }
    return std::nullopt;
  }
}

int TextureLoader::checker() {
  if (checker_ < 0) {
    checker_ = static_cast<int>(scene_.textures.size());
    scene_.textures.push_back({"(default checker)", checkerBitmap()});
  }
  return checker_;
}

}  // namespace lucerna
