// glTF files that tests write.
#pragma once

#include "base/log.hpp"
#include "scene/scene.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstring>
#include <string>
#include <vector>

namespace lucerna::test {

template <class T>
std::string bytesOf(const std::vector<T>& values) {
  std::string bytes(sizeof(T) * values.size(), '\0');
  if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

inline std::string bytesOf(std::initializer_list<float> values) { return bytesOf(std::vector<float>(values)); }

/// RFC 4648.
inline std::string base64(const std::string& bytes) {
  const char* letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (i + k < bytes.size() ? static_cast<std::uint8_t>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k) text += i + k > bytes.size() ? '=' : letters[three >> (18 - 6 * k) & 63u];
  }
  return text;
}

/// A file of one mesh of one primitive in one node, to begin with: the triangle (0,0,0) (1,0,0) (0,1,0).
class Gltf {
 public:
  using Json = nlohmann::json;
  static constexpr int kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123, kUnsignedInt = 5125,
                       kFloat = 5126;
  Gltf() {
    root = {{"asset", {{"version", "2.0"}}},
            {"scene", 0},
            {"scenes", {{{"nodes", {0}}}}},
            {"nodes", {{{"mesh", 0}}}},
            {"meshes", {{{"primitives", {{{"attributes", Json::object()}}}}}}}};
    attributes()["POSITION"] = floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  }

  Json& primitive() { return root["meshes"][0]["primitives"][0]; }
  Json& attributes() { return primitive()["attributes"]; }
  Json& node() { return root["nodes"][0]; }

  int view(const std::string& bytes, int stride = 0) {
    buffer_.append((4 - buffer_.size() % 4) % 4, '\0');
    Json v = {{"buffer", 0}, {"byteOffset", buffer_.size()}, {"byteLength", bytes.size()}};
    if (stride > 0) v["byteStride"] = stride;
    buffer_ += bytes;
    return add("bufferViews", v);
  }
  int accessor(int view, int type, const char* shape, std::size_t count, bool normalized = false) {
    Json a = {{"bufferView", view}, {"componentType", type}, {"type", shape}, {"count", count}};
    if (normalized) a["normalized"] = true;
    return add("accessors", a);
  }
  int floats(std::initializer_list<float> values, const char* shape) {
    const std::string_view kind = shape;
    const std::size_t width = kind == "SCALAR" ? 1U : kind == "MAT4" ? 16U : static_cast<std::size_t>(kind[3] - '0');
    return accessor(view(bytesOf(values)), kFloat, shape, values.size() / width);
  }
  int add(const char* array, const Json& member) {
    root[array].push_back(member);
    return static_cast<int>(root[array].size()) - 1;
  }

  /// With its numbers as data in the text.
  std::string text() const {
    Json whole = root;
    if (!whole.contains("buffers"))
      whole["buffers"] = {
          {{"byteLength", buffer_.size()}, {"uri", "data:application/octet-stream;base64," + base64(buffer_)}}};
    return whole.dump();
  }
  std::string binary() const {
    Json whole = root;
    whole["buffers"] = {{{"byteLength", buffer_.size()}}};
    std::string json = whole.dump(), data = buffer_;
    json.append((4 - json.size() % 4) % 4, ' ');
    data.append((4 - data.size() % 4) % 4, '\0');
    const auto word = [](std::size_t value) {
      return bytesOf(std::vector<std::uint32_t>{static_cast<std::uint32_t>(value)});
    };
    return "glTF" + word(2) + word(12 + 8 + json.size() + 8 + data.size()) + word(json.size()) + "JSON" + json +
           word(data.size()) + std::string("BIN\0", 4) + data;
  }
  const std::string& numbers() const { return buffer_; }
  Scene load() const {
    clearLoggedWarnings();
    const TempFolder folder;
    return loadScene(folder.write("a.gltf", text()));
  }
  std::string refusal() const {
    return badInputMessage([&] { load(); });
  }

  Json root;

 private:
  std::string buffer_;
};

/// Corners of all triangles in turn.
inline std::vector<glm::vec3> corners(const Scene& scene) {
  std::vector<glm::vec3> result;
  for (const std::uint32_t i : scene.indices) result.push_back(scene.vertices[i].position);
  return result;
}

inline void expectCorners(const Scene& scene, const std::vector<glm::vec3>& expected, float within = 1e-6f) {
  const std::vector<glm::vec3> found = corners(scene);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_LT(glm::distance(found[i], expected[i]), within)
        << i << ": " << found[i].x << " " << found[i].y << " " << found[i].z;
}

}  // namespace lucerna::test
