#include "base/json.hpp"

namespace lucerna {

void checkJsonDepth(std::string_view text, std::string_view name) {
  int depth = 0;
  bool inText = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (inText && c == '\\') ++i;  // an escaped character ends no string
    else if (c == '"') inText = !inText;
    else if (!inText && (c == '{' || c == '[')) ++depth;
    else if (!inText && (c == '}' || c == ']')) --depth;
    if (depth > kMostJsonDepth) throwBadInput("{}: JSON nested more than {} deep", name, kMostJsonDepth);
  }
}

}  // namespace lucerna
