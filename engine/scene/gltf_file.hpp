// A glTF 2 file: its JSON, checked where a reader relies on it, and its numbers in double (no GL; private to
// engine/scene). Source: glTF 2.0 specification [GLTF2] and the extensions named below.
//
// Why no library reads it: tinygltf, the one that Debian packages, leaves accessors, strips, morphing, skins and
// extensions to its users, drops values of a wrong type without a word, and would be one more parser to harden. What it
// would save is the walk over JSON that we parse anyway.
#pragma once

#include "scene/json_value.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

/// An accessor's elements in double: integers that are `normalized` between -1 and 1, others as they are. They are
/// read where they lie in the file, so that primitives may share large accessors; not beyond the life of the GltfFile.
class GltfNumbers {
 public:
  std::size_t count = 0;  ///< elements
  std::size_t width = 0;  ///< numbers of an element: 1 to 4, or 16

  double at(std::size_t element, std::size_t k) const;
  glm::dvec3 vector(std::size_t element) const { return {at(element, 0), at(element, 1), at(element, 2)}; }

 private:
  friend class GltfFile;
  struct Elements {
    std::span<const std::uint8_t> bytes;  ///< empty: all zero
    std::size_t stride = 0;
  };
  Elements elements_, replacements_;
  std::map<std::size_t, std::size_t> replaced_;  ///< of a sparse accessor: element, and which replacement it has
  int componentType_ = 0;
  bool normalized_ = false;
};

class GltfFile {
 public:
  /// Throws Error(badInput) naming the file and the cause if it is not glTF 2, requires an extension that is not
  /// supported, or if its nodes are no trees.
  GltfFile(const std::filesystem::path& file, std::span<const std::uint8_t> bytes);

  const std::filesystem::path& path() const { return file_; }
  Value root() const { return {root_, file_, ""}; }
  /// Length of an array of the root; 0 if there is none.
  std::size_t count(std::string_view array) const;
  Value at(std::string_view array, std::size_t index) const { return root().at(array).at(index); }
  /// The number that a key holds, of a member of `array`. Throws if there is no such member.
  std::size_t indexOf(const Value& value, std::string_view array) const;
  /// An extension of an object, if the object has it.
  static std::optional<Value> extension(const Value& object, std::string_view name);
  /// Extensions that the file uses, that are not supported and that no material has, whose reader names them.
  std::vector<std::string> unsupported() const;

  /// `types`: those allowed, such as "VEC3 VEC4". Throws if the accessor is broken or its numbers are not there.
  GltfNumbers numbers(std::size_t accessor, std::string_view types) const;
  /// Unsigned integers alone.
  std::vector<std::uint32_t> indices(std::size_t accessor) const;
  /// The bytes of a buffer view.
  std::span<const std::uint8_t> bytesOfView(std::size_t view) const;

  /// Of the file and the buffers read so far.
  std::size_t bytesRead() const;

  /// The parent of each node; -1: none.
  const std::vector<int>& parents() const { return parents_; }

 private:
  void checkVersion() const;
  void checkExtensions() const;
  void readParents();
  std::span<const std::uint8_t> bytesOfBuffer(std::size_t buffer) const;
  GltfNumbers::Elements elementsAt(std::size_t accessor, const Value& place, std::size_t count, std::size_t component,
                                   std::size_t width) const;

  std::filesystem::path file_;
  std::size_t size_;
  Json root_;
  std::optional<std::vector<std::uint8_t>> binary_;  ///< of a binary file
  mutable std::map<std::size_t, std::vector<std::uint8_t>> buffers_;  ///< those read so far
  std::vector<int> parents_;
};

/// A non-negative integer, 0 if the object has no such key.
std::size_t wholeNumber(const Value& object, std::string_view key);

/// "data:..." to its bytes; empty if the URI is none. Throws Error(badInput) naming its key if it is broken.
std::optional<std::vector<std::uint8_t>> dataOf(const Value& uri);

/// A URI as the name of a file beside the glTF: percent-encoded characters decoded, unless only the name as it is
/// written is there.
std::string fileNameOf(const Value& uri);

}  // namespace lucerna
