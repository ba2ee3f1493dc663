// The preprocessor before the driver's: includes, declared flags, line map, readable logs. No GL calls.
#include "base/error.hpp"
#include "base/files.hpp"
#include "gl/program.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <fstream>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <sstream>

namespace lucerna::gl {

namespace {

namespace fs = std::filesystem;

class Expander {
 public:
  Expander(const fs::path& root, const ShaderFlags& flags) : root_(root) {
    for (const auto& [name, value] : flags) {
      known_.insert(name);
      values_[name] = value;
    }
  }

  ExpandedSource expand(const std::string& file, const ShaderFlags& flags) {
    emit("#version 430 core", {-1, 0});
    for (const auto& [name, value] : flags) emit(fmt::format("#define {} {}", name, value), {-1, 0});
    include(file, {});
    return std::move(result_);
  }

 private:
  void emit(const std::string& line, ExpandedSource::Line origin) {
    result_.text += line;
    result_.text += '\n';
    result_.lines.push_back(origin);
  }

  void include(const std::string& file, const std::string& from) {
    if (std::find(open_.begin(), open_.end(), file) != open_.end())
      throwBadInput("{}: include cycle back to shaders/{}", from, file);
    const auto& files = result_.files;
    if (std::find(files.begin(), files.end(), fs::path(file)) != files.end()) return;  // include once

    std::ifstream stream(root_ / file);
    if (!stream && errno != ENOENT) throwCannotOpen(root_ / file, errno);
    if (!stream || fs::is_directory(root_ / file))
      throwBadInput("{}shader file shaders/{} is missing", from.empty() ? "" : from + ": ", file);
    open_.push_back(file);
    result_.files.emplace_back(file);
    const int index = static_cast<int>(result_.files.size()) - 1;

    std::string line;
    for (int number = 1; std::getline(stream, line); ++number) {
      if (!line.empty() && line.back() == '\r') line.pop_back();
      const std::string where = fmt::format("shaders/{}:{}", file, number);
      static const std::regex kInclude(R"(^\s*#\s*include\s+"([^"]+)\"\s*(//.*)?$)");
      static const std::regex kCondition(R"(^\s*#\s*(if|ifdef|ifndef|elif)\b(.*)$)");
      static const std::regex kDefine(R"(^\s*#\s*define\s+([A-Za-z_]\w*).*$)");
      static const std::regex kVersion(R"(^\s*#\s*version\b.*$)");
      std::smatch match;
      if (std::regex_match(line, match, kInclude)) {
        if (std::find(branches_.begin(), branches_.end(), false) == branches_.end()) include(match[1], where);
        continue;
      }
      if (std::regex_match(line, match, kCondition)) checkCondition(match[2], where);
      followBranches(line);
      if (std::find(branches_.begin(), branches_.end(), false) != branches_.end()) {
        emit(line, {index, number});  // left out by a flag
        continue;
      }
      if (std::regex_match(line, kVersion))
        throwBadInput("{}: #version is written by the library, leave it out", where);
      if (std::regex_match(line, match, kDefine)) known_.insert(match[1]);
      emit(line, {index, number});
    }
    open_.pop_back();
  }

  // Tracks open branches, so that a branch disabled by a flag includes nothing. Only `#if FLAG`, `#if !FLAG` and their
  // #elif, #else are evaluated; any other condition counts as taken, its #else too.
  void followBranches(const std::string& line) {
    static const std::regex kFlag(R"(^\s*#\s*(if|elif)\s+(!?)\s*([A-Za-z_]\w*)\s*(//.*)?$)");
    static const std::regex kOpen(R"(^\s*#\s*(if|ifdef|ifndef)\b.*$)");
    static const std::regex kElse(R"(^\s*#\s*(elif|else)\b.*$)");
    static const std::regex kEnd(R"(^\s*#\s*endif\b.*$)");
    std::smatch match;
    std::optional<bool> value;
    if (std::regex_match(line, match, kFlag) && values_.contains(match[3]))
      value = (values_[match[3]] != 0) == match[2].str().empty();
    if (std::regex_match(line, kOpen)) {
      branches_.push_back(value.value_or(true));
      taken_.push_back(value);
    } else if (std::regex_match(line, kElse) && !branches_.empty()) {
      // An earlier branch that is certainly taken closes the later ones; after one that is certainly not taken, each
      // depends on its own flag.
      branches_.back() = taken_.back() == true ? false : value.value_or(true);
      if (taken_.back() != true)
        taken_.back() = value == true ? std::optional(true) : taken_.back() == false ? value : std::nullopt;
    } else if (std::regex_match(line, kEnd) && !branches_.empty()) {
      branches_.pop_back();
      taken_.pop_back();
    }
  }

  // Every identifier in a condition must be a declared flag or a macro defined in the file.
  void checkCondition(std::string condition, const std::string& where) {
    if (const auto comment = condition.find("//"); comment != std::string::npos) condition.resize(comment);
    static const std::regex kIdentifier(R"([A-Za-z_]\w*)");
    for (auto it = std::sregex_iterator(condition.begin(), condition.end(), kIdentifier); it != std::sregex_iterator();
         ++it) {
      const std::string name = it->str();
      if (name == "defined" || name.starts_with("GL_") || name.starts_with("__") || known_.contains(name)) continue;
      throwBadInput("{}: flag {} is not declared by the program (declared: {})", where, name, fmt::join(known_, ", "));
    }
  }

  fs::path root_;
  std::set<std::string> known_;
  std::map<std::string, int> values_;
  std::vector<bool> branches_;  // whether each open #if's current branch counts as taken
  std::vector<std::optional<bool>> taken_;  // whether an earlier branch was certainly taken, certainly not, or unknown
  std::vector<std::string> open_;
  ExpandedSource result_;
};

}  // namespace

ExpandedSource expandShader(const fs::path& root, const std::string& file, const ShaderFlags& flags) {
  return Expander(root, flags).expand(file, flags);
}

std::string rewriteShaderLog(const std::string& log, const ExpandedSource& source) {
  // Mesa "0:12(3): error: ...", NVIDIA "0(12) : error C...", AMD and Intel "ERROR: 0:12: ..."
  static const std::regex kPlace(R"(^(ERROR: |WARNING: )?\d+[:\(](\d+)(\)|\(\d+\))?\s*:\s*(.*)$)");
  std::istringstream stream(log);
  std::string line, result;
  while (std::getline(stream, line)) {
    std::smatch match;
    if (std::regex_match(line, match, kPlace)) {
      const auto number = static_cast<std::size_t>(std::stoul(match[2]));
      if (number >= 1 && number <= source.lines.size() && source.lines[number - 1].file >= 0) {
        const auto& place = source.lines[number - 1];
        line = fmt::format("shaders/{}:{}: {}{}", source.files[static_cast<std::size_t>(place.file)].string(),
                           place.line, match[1].str(), match[4].str());
      }
    }
    if (!line.empty()) result += line + "\n";
  }
  return result;
}

}  // namespace lucerna::gl
