// Words that resemble a mistyped one, for error messages.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lucerna {

/// Letters to insert, drop, replace or swap with their neighbour to make `a` of `b` (optimal string alignment).
inline std::size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> twoBefore, before(b.size() + 1), row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) before[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({before[j] + 1, row[j - 1] + 1, before[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], twoBefore[j - 2] + 1);
    }
    twoBefore = std::exchange(before, row);
  }
  return before[b.size()];
}

/// At most `most` of `words`, nearest first. The part before a word's last dot may be missing or another, for one edit,
/// and so may be the end of a word.
inline std::vector<std::string_view> nearestWords(std::string_view word, std::vector<std::string_view> words,
                                                  std::size_t most = 4) {
  const auto afterDot = [](std::string_view w) { return w.substr(w.rfind('.') + 1); };  // npos + 1 is 0
  const auto beforeDot = [](std::string_view w) { return w.substr(0, w.rfind('.') + 1); };
  const auto distance = [&](std::string_view w) {
    const bool isBeginning = !word.empty() && w.size() > word.size() && w.starts_with(word);
    const std::size_t edits = std::min(editDistance(word, w), editDistance(afterDot(word), afterDot(w)) + 1);
    return std::pair(isBeginning ? std::size_t{1} : edits, beforeDot(word) != beforeDot(w));
  };
  std::sort(words.begin(), words.end());
  words.erase(std::unique(words.begin(), words.end()), words.end());
  std::ranges::stable_sort(words, {}, distance);
  words.resize(std::min(most, words.size()));
  return words;
}

/// The same as a list: "first, second".
inline std::string nearestList(std::string_view word, std::vector<std::string_view> words, std::size_t most = 4) {
  std::string list;
  for (const std::string_view near : nearestWords(word, std::move(words), most))
    list.append(list.empty() ? "" : ", ").append(near);
  return list;
}

}  // namespace lucerna
