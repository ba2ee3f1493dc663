// Lines and words of the text formats OBJ, MTL, PLY and STL (no GL, pure).
#pragma once

#include <charconv>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

namespace lucerna {

inline std::string lowerCase(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return lower;
}

/// A decimal number as programs print them, also NaN and infinity in Microsoft's spelling; empty: it is none.
inline std::optional<double> numberIn(std::string_view text) {
  if (!text.empty() && text[0] == '+') text.remove_prefix(1);
  double value = 0.0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error == std::errc::invalid_argument) return std::nullopt;
  if (error == std::errc::result_out_of_range) value = std::strtod(std::string(text).c_str(), nullptr);
  if (stop == end) return value;
  const std::string_view rest(stop, static_cast<std::size_t>(end - stop));  // 1.#IND, -1.#INF00
  if (!rest.starts_with("#I") && !rest.starts_with("#Q") && !rest.starts_with("#S")) return std::nullopt;
  return rest.starts_with("#INF") ? value * std::numeric_limits<double>::infinity()
                                  : std::numeric_limits<double>::quiet_NaN();
}

/// Goes through a text line by line. Lines end with \n, \r\n or \r; if asked for, a backslash before the end continues
/// a line that is no comment (#).
class TextLines {
 public:
  explicit TextLines(std::string_view text, bool continues = false) : text_(text), mayContinue_(continues) {}

  /// Goes to the next line; false: there is none.
  bool next() {
    while (begun_ && at_ < text_.size() && !isEnd(text_[at_])) {
      if (!continued()) ++at_;
    }
    if (begun_) skipEnd();
    begun_ = true;
    ++line_;
    const std::size_t first = text_.find_first_not_of(" \t", at_);
    continues_ = mayContinue_ && first != std::string_view::npos && text_[first] != '#';
    return at_ < text_.size();
  }
  int line() const { return line_; }
  /// Behind the last word, in the text.
  std::size_t position() const { return at_; }

  /// The next word of the line; empty at its end.
  std::string_view word() {
    skipBlanks();
    const std::size_t begin = at_;
    while (at_ < text_.size() && !isBlank(text_[at_]) && !isEnd(text_[at_]) && !isContinuation(at_)) ++at_;
    return text_.substr(begin, at_ - begin);
  }
  /// The rest of the line without the blanks around it: names may contain some.
  std::string_view rest() {
    skipBlanks();
    const std::size_t begin = at_;
    while (at_ < text_.size() && !isEnd(text_[at_])) ++at_;
    std::size_t end = at_;
    while (end > begin && isBlank(text_[end - 1])) --end;
    return text_.substr(begin, end - begin);
  }
  /// Whether the text ends on this line, without a line end.
  bool isCutOff() const { return text_.find_first_of("\r\n", at_) == std::string_view::npos; }

 private:
  static bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
  static bool isEnd(char c) { return c == '\n' || c == '\r'; }
  bool isContinuation(std::size_t at) const {
    return text_[at] == '\\' && continues_ && (at + 1 >= text_.size() || isEnd(text_[at + 1]));
  }
  void skipEnd() {
    if (at_ >= text_.size()) return;
    at_ += text_[at_] == '\r' && at_ + 1 < text_.size() && text_[at_ + 1] == '\n' ? 2 : 1;
  }
  /// Skips a backslash and the line end after it.
  bool continued() {
    if (!isContinuation(at_)) return false;
    ++at_;
    skipEnd();
    ++line_;
    return true;
  }
  void skipBlanks() {
    while (at_ < text_.size() && (isBlank(text_[at_]) || isContinuation(at_)))
      if (!continued()) ++at_;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 0;
  bool begun_ = false, mayContinue_, continues_ = false;
};

}  // namespace lucerna
