#include "shared/provenance.hpp"

#include "commit.hpp"

#include <fmt/format.h>

#include <cctype>
#include <fstream>
#include <thread>

namespace lucerna::demo::bench {

std::string programVersion() { return fmt::format("{}, commit {}", LUCERNA_VERSION, LUCERNA_COMMIT); }

std::string cpuName() {
  std::ifstream stream("/proc/cpuinfo");
  std::string line, name = "unknown processor";
  while (std::getline(stream, line))
    if (line.starts_with("model name")) {
      name = line.substr(line.find(':') + 2);
      break;
    }
  return fmt::format("{}, {} threads", name, std::thread::hardware_concurrency());
}

std::string shellWord(const std::string& word) {
  bool plain = !word.empty();
  for (const char c : word)
    plain = plain && (std::isalnum(static_cast<unsigned char>(c)) ||
                      std::string_view("_-./,=:+@").find(c) != std::string_view::npos);
  if (plain) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

std::string shellCommand(const std::vector<std::string>& words) {
  std::string command;
  for (const std::string& word : words) command += (command.empty() ? "" : " ") + shellWord(word);
  return command;
}

}  // namespace lucerna::demo::bench
