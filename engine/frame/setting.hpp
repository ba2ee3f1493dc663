// A setting: what users set by key, on the command line (--set KEY=VALUE), in settings files, in the panel and in labs
// (no GL calls). Techniques declare theirs; render/settings.hpp has them all.
//
// From an entry are derived --help, the completions, docs/settings.md (`lucerna info --settings`), the parser with its
// messages, and the warnings about unused settings. Values are written as text; numbers, switches and choices can also
// be read and written as numbers, for sliders and menus.
#pragma once

#include "frame/render_settings.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace lucerna {

enum class SettingType { boolean, integer, real, choice, file };
constexpr std::array<std::string_view, 5> namesOf(SettingType) {
  return {"switch", "integer", "number", "choice", "file"};
}

/// What must be rebuilt before a change takes effect.
enum class SettingCost {
  uniform,  ///< nothing: the next frame uses it (Renderer::apply)
  rebuild,  ///< the Renderer: programs are compiled, textures allocated
  solution,  ///< also radiosity's solution
};
constexpr std::array<std::string_view, 3> namesOf(SettingCost) { return {"uniform", "rebuild", "solution"}; }

/// Type, range and location of a value. As numbers, switches are 0 and 1, choices their index in `choices`.
struct SettingValue {
  SettingType type = SettingType::real;
  double least = 0.0, most = 0.0;  ///< for numbers
  std::vector<std::string_view> choices;  ///< for a choice, in order
  std::string_view word;  ///< accepted instead of a number: "auto", "all"; empty: none
  double wordNumber = 0.0;  ///< the number it stands for; NaN: no value is set, the default applies
  bool singlePrecision = false;  ///< a float: printed with as few digits as it needs
  double (*get)(const RenderSettings&) = nullptr;
  void (*set)(RenderSettings&, double) = nullptr;
  std::string (*getFile)(const RenderSettings&) = nullptr;  ///< for a file, which has no number
  void (*setFile)(RenderSettings&, const std::string&) = nullptr;
};

struct Setting {
  std::string_view key;  ///< technique or stage, dot, name
  SettingValue value;
  std::string_view unit;  ///< empty: a pure number, or not a number
  std::string_view meaning;  ///< one line, without default and range
  std::string_view source = "";  ///< keys of shaders/REFERENCES.md; empty: our own
  SettingCost cost = SettingCost::rebuild;
  std::string_view with = "";  ///< a value without which it is not read: "cache.transport=gather"
  std::string_view usually = "";  ///< the default, if the command line does not simply take that of RenderSettings
  std::string_view group = "";  ///< of settings that several techniques read; empty: its technique's own
};

/// The value in the form that --set takes.
std::string printSetting(const Setting& setting, const RenderSettings& settings);
/// Sets it from text. Throws Error(badInput) whose message begins with `where` and the key and lists the valid values.
void parseSetting(const Setting& setting, RenderSettings& settings, std::string_view value,
                  std::string_view where = "");
/// Value as a number, not for files. Setting rounds integers; values out of range or not finite throw as in
/// parseSetting.
double settingNumber(const Setting& setting, const RenderSettings& settings);
void setSettingNumber(const Setting& setting, RenderSettings& settings, double number);

/// "1 to 128", "on or off", "flux, published", with the word accepted instead.
std::string allowedValues(const Setting& setting);
/// The default in the form that --set takes, or in words.
std::string defaultValue(const Setting& setting);

/// Kinds of values, for tables of settings. SETTING_FIELD(LpvSettings, bounces) is a place in a
/// technique's settings, FRAME_FIELD(reuse) one in RenderSettings.
namespace setting_values {

#define SETTING_FIELD(Settings, member) \
  [](auto& s) -> auto& { return s.template of<Settings>().member; }
#define FRAME_FIELD(member) \
  [](auto& s) -> auto& { return s.member; }

template <class Field>
using FieldType = std::remove_cvref_t<decltype(Field{}(std::declval<RenderSettings&>()))>;

inline SettingValue valueOf(SettingType type, double least = 0.0, double most = 0.0,
                            std::vector<std::string_view> choices = {}) {
  SettingValue value;
  value.type = type;
  value.least = least;
  value.most = most;
  value.choices = std::move(choices);
  return value;
}

template <class Field>
SettingValue boolean(Field) {
  SettingValue value = valueOf(SettingType::boolean, 0.0, 1.0);
  value.get = [](const RenderSettings& s) { return Field{}(s) ? 1.0 : 0.0; };
  value.set = [](RenderSettings& s, double number) { Field{}(s) = number != 0.0; };
  return value;
}

/// Of any arithmetic type; `word` stands for `wordNumber`.
template <class Field>
SettingValue number(Field, double least, double most, std::string_view word = "", double wordNumber = 0.0) {
  using T = FieldType<Field>;
  SettingValue value = valueOf(std::is_integral_v<T> ? SettingType::integer : SettingType::real, least, most);
  value.word = word;
  value.wordNumber = wordNumber;
  value.singlePrecision = std::is_same_v<T, float>;
  value.get = [](const RenderSettings& s) { return static_cast<double>(Field{}(s)); };
  value.set = [](RenderSettings& s, double n) { Field{}(s) = static_cast<T>(n); };
  return value;
}

/// An optional number; "auto" if it is not set.
template <class Field>
SettingValue optionalNumber(Field, double least, double most) {
  using T = typename FieldType<Field>::value_type;
  SettingValue value = valueOf(SettingType::real, least, most);
  value.word = "auto";
  value.wordNumber = std::numeric_limits<double>::quiet_NaN();
  value.singlePrecision = std::is_same_v<T, float>;
  value.get = [](const RenderSettings& s) {
    return Field{}(s) ? static_cast<double>(*Field{}(s)) : std::numeric_limits<double>::quiet_NaN();
  };
  value.set = [](RenderSettings& s, double n) {
    if (std::isnan(n)) Field{}(s).reset();
    else Field{}(s) = static_cast<T>(n);
  };
  return value;
}

template <class Field>
SettingValue choice(Field) {
  using E = FieldType<Field>;
  SettingValue value = valueOf(SettingType::choice);
  for (const std::string_view name : namesOf(E{})) value.choices.push_back(name);
  value.most = static_cast<double>(value.choices.size() - 1);
  value.get = [](const RenderSettings& s) { return static_cast<double>(Field{}(s)); };
  value.set = [](RenderSettings& s, double n) { Field{}(s) = static_cast<E>(static_cast<int>(n)); };
  return value;
}

template <class Field>
SettingValue file(Field) {
  SettingValue value = valueOf(SettingType::file);
  value.getFile = [](const RenderSettings& s) { return Field{}(s).string(); };
  value.setFile = [](RenderSettings& s, const std::string& text) { Field{}(s) = text; };
  return value;
}

/// Bytes, given in MiB; 0 is "auto".
template <class Field>
SettingValue mebibytes(Field, double most) {
  SettingValue value = valueOf(SettingType::real, 0.0, most);
  value.word = "auto";
  value.get = [](const RenderSettings& s) { return static_cast<double>(Field{}(s)) / 1048576.0; };
  value.set = [](RenderSettings& s, double mib) { Field{}(s) = static_cast<std::size_t>(mib * 1048576.0); };
  return value;
}

/// Pixels per side of a hemicube: its side faces have half as many rows.
template <class Field>
SettingValue evenNumber(Field field, double least, double most) {
  SettingValue value = number(field, least, most);
  value.set = [](RenderSettings& s, double n) { Field{}(s) = 2 * (static_cast<int>(n) / 2); };
  return value;
}

}  // namespace setting_values

}  // namespace lucerna
