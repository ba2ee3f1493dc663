// The values are stored as the description of a validator that is never active: CLI11 options have no other field for
// user data.
#include "offers.hpp"

#include <CLI/App.hpp>

#include <sstream>
#include <utility>

namespace lucerna::demo {

namespace {

constexpr const char* kName = "offers";

}  // namespace

Option offer(Option option, const std::vector<std::string>& values) {
  try {
    option.cli11().get_validator(kName)->description(joined(values));
  } catch (const CLI::OptionNotFound&) {
    CLI::Validator validator([](std::string&) { return std::string(); }, joined(values), kName);
    option.cli11().check(validator.active(false));
  }
  return option;
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text.append(text.empty() ? "" : " ").append(word);
  return text;
}

std::vector<std::string> offered(Option option) {
  std::vector<std::string> values;
  try {
    std::istringstream text(std::as_const(*option.cli11().get_validator(kName)).active(true).get_description());
    for (std::string value; text >> value;) values.push_back(value);
  } catch (const CLI::OptionNotFound&) {}
  return values;
}

}  // namespace lucerna::demo
