// A strict check of Wavefront OBJ text before Assimp reads it. Assimp 5.2 accepts a face cut down to two vertices (the
// usual end of a truncated file) and texture-coordinate or normal indices that no line defines, and names no lines.
// Only what a loader must rely on is checked: the numbers of v, vt, vn and the indices of f; everything else passes.
// Source: "Advanced Visualizer Manual", appendix B1, Wavefront Technologies (object files).
#include "scene/scene_file.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <string>

namespace lucerna {

namespace {

/// Position, texture coordinate, normal: the parts of a face's vertex.
constexpr std::array<const char*, 3> kPartNames = {"v", "vt", "vn"};

class ObjChecker {
 public:
  ObjChecker(const std::filesystem::path& file, std::string_view text) : file_(file), text_(text) {}

  void run() {
    if (text_.empty()) fail("the file is empty");
    if (std::memchr(text_.data(), '\0', text_.size())) fail("binary data, expected Wavefront OBJ text");
    while (at_ < text_.size()) {
      ++line_;
      const std::string_view keyword = word();
      if (keyword == "v") numbers(keyword, 3, 0);
      else if (keyword == "vt") numbers(keyword, 1, 1);
      else if (keyword == "vn") numbers(keyword, 3, 2);
      else if (keyword == "f") face();
      endsWithLineEnd_ = !lastLine();
      skipLine();
    }
    endsInUnusedVertex();
    // Faces may refer to vertices further down, so this is checked only at the end.
    for (std::size_t part = 0; part < 3; ++part) {
      if (highest_[part] <= counts_[part]) continue;
      line_ = highestLine_[part];
      fail(fmt::format("a face refers to {} number {}, the file holds {}; is it cut off?", kPartNames[part],
                       highest_[part], counts_[part]));
    }
  }

 private:
  /// The next word of the line, empty at its end. A backslash before the line's end continues the line.
  std::string_view word() {
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '\\' && isLineEnd(at_ + 1)) {
        at_ = text_.find('\n', at_);
        if (at_ == std::string_view::npos) at_ = text_.size() - 1;
        ++line_;
      } else if (c != ' ' && c != '\t' && c != '\r') {
        break;
      }
    }
    const std::size_t begin = at_;
    while (at_ < text_.size() && text_[at_] != ' ' && text_[at_] != '\t' && text_[at_] != '\r' && text_[at_] != '\n')
      ++at_;
    return text_.substr(begin, at_ - begin);
  }

  bool isLineEnd(std::size_t at) const {
    return at >= text_.size() || text_[at] == '\n' ||
           (text_[at] == '\r' && (at + 1 >= text_.size() || text_[at + 1] == '\n'));
  }

  void skipLine() { at_ = std::min(text_.find('\n', at_), text_.size() - 1) + 1; }

  void numbers(std::string_view keyword, int needed, std::size_t part) {
    for (int i = 0; i < needed; ++i) {
      std::string_view text = word();
      if (text.empty()) fail(fmt::format("{} has {} numbers, expected {}; is the file truncated?", keyword, i, needed));
      if (text[0] == '+') text.remove_prefix(1);
      float value = 0.0f;  // non-finite values are allowed here: the loader drops and counts such triangles
      const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
      if (error == std::errc::invalid_argument || end != text.data() + text.size())
        fail(fmt::format("'{}' in a {} line, expected a number", text, keyword));
    }
    ++counts_[part];
    lastPart_ = static_cast<int>(part);
  }

  void face() {
    lastPart_ = -1;
    int vertices = 0;
    std::array<bool, 3> partsOfFirst{};
    for (std::string_view text = word(); !text.empty(); text = word()) {
      if (text[0] == '#') fail("a comment after a face, which Assimp cannot read; expected it on a line of its own");
      std::array<bool, 3> parts{};
      const char* next = text.data();
      const char* const end = text.data() + text.size();
      for (std::size_t part = 0; part < 3 && next < end; ++part) {
        if (*next != '/') {
          long index = 0;
          const auto [stop, error] = std::from_chars(next, end, index);
          if (error != std::errc() || index == 0 || (stop != end && *stop != '/'))
            fail(fmt::format(
                "'{}' in a face, expected index, index/index or index/index/index from 1 up or from -1 down", text));
          if (index < 0 && index < -counts_[part])
            fail(fmt::format("a face refers to {} number {}, only {} come before it", kPartNames[part], index,
                             counts_[part]));
          if (index > highest_[part]) {
            highest_[part] = index;
            highestLine_[part] = line_;
          }
          parts[part] = true;
          next = stop;
        }
        if (next < end) ++next;  // the slash
      }
      if (next < end || !parts[0])
        fail(fmt::format("'{}' in a face, expected index, index/index or index/index/index", text));
      if (vertices == 0) partsOfFirst = parts;
      else if (lastLine() && parts != partsOfFirst) fail(fmt::format("the file ends within a face, at '{}'", text));
      ++vertices;
    }
    // Elsewhere such faces are merely useless; at the very end they indicate a truncated file.
    if (vertices < 3 && lastLine())
      fail(fmt::format("the file ends within a face: {} vertices, expected at least 3", vertices));
  }

  /// Vertices come before the faces that use them. If the last line has no line end and defines a vertex that no face
  /// uses, the file was truncated.
  void endsInUnusedVertex() const {
    if (endsWithLineEnd_ || lastPart_ < 0) return;
    const auto part = static_cast<std::size_t>(lastPart_);
    if (highest_[part] < counts_[part]) fail("the file ends within its vertices: it is cut off");
  }

  /// Whether the text ends on this line without a line end.
  bool lastLine() const { return text_.find('\n', at_) == std::string_view::npos; }

  [[noreturn]] void fail(const std::string& what) const {
    throwBadInput("{}:{}: {}", file_.string(), std::max(line_, 1), what);
  }

  const std::filesystem::path& file_;
  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 0;
  std::array<long, 3> counts_{};  ///< lines v, vt, vn so far
  std::array<long, 3> highest_{};  ///< highest index in any face
  std::array<int, 3> highestLine_{};  ///< its line
  int lastPart_ = -1;  ///< defined by the last line among v, vt, vn, f; -1: a face
  bool endsWithLineEnd_ = true;
};

}  // namespace

void checkObj(const std::filesystem::path& file, std::string_view text) { ObjChecker(file, text).run(); }

std::string repairedObj(std::string_view obj) {
  std::string text;
  text.reserve(obj.size() + obj.size() / 16);
  const auto isBlank = [](char c) { return c == ' ' || c == '\t'; };
  bool vertex = false,
       continued = false;  // within a line of v, vt or vn; whether a backslash continues the previous line
  for (std::size_t i = 0; i < obj.size(); ++i) {
    if (i == 0 || obj[i - 1] == '\n') {
      const std::size_t end = obj.substr(0, i).find_last_not_of("\r\n");
      continued = i > 0 && end != std::string_view::npos && obj[end] == '\\';
      if (!continued) {
        while (i < obj.size() && isBlank(obj[i])) ++i;
        if (i == obj.size()) break;
        vertex = obj[i] == 'v';
      }
    }
    if (vertex && obj[i] == '.' && i > 0 && (isBlank(obj[i - 1]) || obj[i - 1] == '\n')) text += '0';
    text += obj[i];
  }
  return text;
}

}  // namespace lucerna
