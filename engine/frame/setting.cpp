#include "frame/setting.hpp"

#include "base/error.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>

namespace lucerna {

namespace {

std::string numberText(const SettingValue& value, double number) {
  if (!value.word.empty() && (number == value.wordNumber || (std::isnan(number) && std::isnan(value.wordNumber))))
    return std::string(value.word);
  if (value.type == SettingType::integer) return fmt::format("{}", static_cast<long long>(number));
  return value.singlePrecision ? fmt::format("{}", static_cast<float>(number)) : fmt::format("{}", number);
}

std::string joined(const std::vector<std::string_view>& words) { return fmt::format("{}", fmt::join(words, ", ")); }

/// The number as stored in the setting's type: a rounded float is brought back within its bounds.
double held(const SettingValue& value, double number) {
  return value.singlePrecision ? static_cast<double>(static_cast<float>(number)) : number;
}

bool isWithin(const SettingValue& value, double number) {
  return held(value, number) >= held(value, value.least) && held(value, number) <= held(value, value.most);
}

[[noreturn]] void refuse(const Setting& setting, std::string_view value, std::string_view where) {
  const std::string begin = fmt::format("{}{}: '{}' is ", where, setting.key, value);
  switch (setting.value.type) {
    case SettingType::boolean: throwBadInput("{}neither on nor off", begin);
    case SettingType::choice: throwBadInput("{}unknown; expected one of {}", begin, joined(setting.value.choices));
    case SettingType::integer: throwBadInput("{}not a whole number from {}", begin, allowedValues(setting));
    case SettingType::real: throwBadInput("{}not a number from {}", begin, allowedValues(setting));
    case SettingType::file: throwBadInput("{}no name of a file", begin);
  }
  CHECK(false, "type {}", static_cast<int>(setting.value.type));
}

template <class T>
std::optional<double> parsed(std::string_view text) {
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return static_cast<double>(value);
}

}  // namespace

std::string printSetting(const Setting& setting, const RenderSettings& settings) {
  const SettingValue& value = setting.value;
  if (value.type == SettingType::file) return value.getFile(settings);
  const double number = value.get(settings);
  if (value.type == SettingType::boolean) return number != 0.0 ? "on" : "off";
  if (value.type == SettingType::choice) return std::string(value.choices.at(static_cast<std::size_t>(number)));
  return numberText(value, number);
}

void parseSetting(const Setting& setting, RenderSettings& settings, std::string_view text, std::string_view where) {
  const SettingValue& value = setting.value;
  const auto set = [&](std::optional<double> number) {
    if (!number || !isWithin(value, *number)) refuse(setting, text, where);
    value.set(settings, *number);
  };
  switch (value.type) {
    case SettingType::file: value.setFile(settings, std::string(text)); return;
    case SettingType::boolean:
      for (const std::string_view on : {"on", "true", "1"})
        if (text == on) return set(1.0);
      for (const std::string_view off : {"off", "false", "0"})
        if (text == off) return set(0.0);
      refuse(setting, text, where);
    case SettingType::choice: {
      const auto found = std::find(value.choices.begin(), value.choices.end(), text);
      if (found == value.choices.end()) refuse(setting, text, where);
      return set(static_cast<double>(found - value.choices.begin()));
    }
    case SettingType::integer:
    case SettingType::real:
      if (!value.word.empty() && text == value.word) return value.set(settings, value.wordNumber);
      return set(value.type == SettingType::integer ? parsed<long long>(text) : parsed<double>(text));
  }
}

double settingNumber(const Setting& setting, const RenderSettings& settings) {
  CHECK(setting.value.get, "{} is no number", setting.key);
  return setting.value.get(settings);
}

void setSettingNumber(const Setting& setting, RenderSettings& settings, double number) {
  const SettingValue& value = setting.value;
  CHECK(value.set, "{} is no number", setting.key);
  const bool isWord =
      !value.word.empty() && (number == value.wordNumber || (std::isnan(number) && std::isnan(value.wordNumber)));
  if (value.type != SettingType::real && std::isfinite(number)) number = std::round(number);
  if (!isWord && !isWithin(value, number)) refuse(setting, fmt::format("{}", number), "");
  value.set(settings, number);
}

std::string allowedValues(const Setting& setting) {
  const SettingValue& value = setting.value;
  switch (value.type) {
    case SettingType::boolean: return "on or off";
    case SettingType::choice: return joined(value.choices);
    case SettingType::file: return "a file";
    case SettingType::integer:
    case SettingType::real: break;
  }
  // Bounds as numbers, even if a word stands for one of them.
  SettingValue plain;
  plain.type = value.type;
  return fmt::format("{} to {}{}", numberText(plain, value.least), numberText(plain, value.most),
                     value.word.empty() ? "" : fmt::format(", or {}", value.word));
}

std::string defaultValue(const Setting& setting) {
  return setting.usually.empty() ? printSetting(setting, RenderSettings{}) : std::string(setting.usually);
}

}  // namespace lucerna
