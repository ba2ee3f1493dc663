// 64-bit FNV-1a: compares contents and detects damaged files; not cryptographic (no GL).
#pragma once

#include <glm/glm.hpp>

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>

namespace lucerna {

class Hash {
 public:
  void bytes(const void* data, std::size_t size) {
    const auto* p = static_cast<const std::uint8_t*>(data);
    for (std::size_t i = 0; i < size; ++i) value_ = (value_ ^ p[i]) * 0x100000001b3u;
  }
  /// Only for types without padding, whose bytes are undefined.
  template <class T>
  void add(const T& value) {
    static_assert(std::is_trivially_copyable_v<T> &&
                  (std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>));
    bytes(&value, sizeof value);
  }
  template <glm::length_t n, class T>
  void add(const glm::vec<n, T>& v) {
    static_assert(sizeof v == n * sizeof(T));
    bytes(&v, sizeof v);
  }
  void add(std::string_view text) {
    add(static_cast<std::uint64_t>(text.size()));
    bytes(text.data(), text.size());
  }
  std::uint64_t value() const { return value_; }
  static std::uint64_t of(const void* data, std::size_t size) {
    Hash hash;
    hash.bytes(data, size);
    return hash.value();
  }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325u;
};

}  // namespace lucerna
