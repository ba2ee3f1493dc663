// The single table of settings: what users set by key, on the command line (--set KEY=VALUE), in settings files, in the
// panel and in labs (no GL calls).
//
// A setting is one entry in settings.cpp. From it are derived --help, the completions, docs/settings.md (`lucerna info
// --settings`), the parser with its messages, and the warnings about unused settings. Values are written as text;
// numbers, switches and choices can also be read and written as numbers, for sliders and menus.
#pragma once

#include "settings/render_settings.hpp"

#include <span>
#include <string>
#include <string_view>
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

/// Readers of a setting: bits 1 << Technique, and for the irradiance cache 1 << CacheTransport.
struct SettingReaders {
  unsigned techniques = 0, transports = 3;
};

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
  std::string_view source;  ///< keys of shaders/REFERENCES.md; empty: our own
  SettingCost cost = SettingCost::rebuild;
  SettingReaders readers;
  std::string_view usually;  ///< the default, if the command line does not simply take that of RenderSettings
};

std::span<const Setting> allSettings();

/// Null if there is none.
const Setting* findSetting(std::string_view key);

/// The value in the form that --set takes.
std::string printSetting(const Setting& setting, const RenderSettings& settings);
/// Sets it from text. Throws Error(badInput) whose message begins with `where` and the key and lists the valid values.
void parseSetting(const Setting& setting, RenderSettings& settings, std::string_view value,
                  std::string_view where = "");
/// Value as a number, not for files. Setting rounds integers; values out of range or not finite throw as in
/// parseSetting.
double settingNumber(const Setting& setting, const RenderSettings& settings);
void setSettingNumber(const Setting& setting, RenderSettings& settings, double number);

/// A parsed "KEY=VALUE".
struct SettingAssignment {
  const Setting* setting;
  std::string value;
};
/// Throws Error(badInput) whose message begins with `where` and lists the valid keys. `only`: keys of that cost; null:
/// all.
SettingAssignment parseAssignment(std::string_view assignment, std::string_view where = "",
                                  const SettingCost* only = nullptr);

/// "1 to 128", "on or off", "flux, published", with the word accepted instead.
std::string allowedValues(const Setting& setting);
/// The default in the form that --set takes, or in words.
std::string defaultValue(const Setting& setting);

/// Whether the technique of `settings` (for the irradiance cache, its transport) reads the setting.
bool isRead(const Setting& setting, const RenderSettings& settings);
bool isReadBy(const Setting& setting, Technique technique);
bool isReadBy(const Setting& setting, CacheTransport transport);  ///< for the irradiance cache
/// The only one that reads the setting; none if several do.
std::optional<Technique> onlyTechnique(const Setting& setting);
/// The only transport of the irradiance cache that reads the setting; none if several do, or that technique does not.
std::optional<CacheTransport> onlyTransport(const Setting& setting);

}  // namespace lucerna
