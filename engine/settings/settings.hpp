// The one table of settings: what people set by a key, on the command line (--set KEY=VALUE), in settings files, in the
// panel and in labs (no GL calls).
//
// A setting is one entry in settings.cpp. From it come --help, the completions, docs/settings.md (`lucerna info
// --settings`), the parser with its messages, and the warnings about settings that nothing reads. Values are written as
// text; numbers, switches and choices can be read and written as numbers too, which is what sliders and menus want.
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

/// What has to be made anew before a change is seen.
enum class SettingCost {
  uniform,  ///< nothing: the next frame has it (Renderer::apply)
  rebuild,  ///< the Renderer: programs are compiled, textures allocated
  solution,  ///< radiosity's solution, too
};
constexpr std::array<std::string_view, 3> namesOf(SettingCost) { return {"uniform", "rebuild", "solution"}; }

/// Who reads a setting: bits 1 << Technique, and of the light propagation volume 1 << LpvTransport.
struct SettingReaders {
  unsigned techniques = 0, transports = 7;
};

/// Type, range and place of a value. Numbers of a switch are 0 and 1, of a choice the position in `choices`.
struct SettingValue {
  SettingType type = SettingType::real;
  double least = 0.0, most = 0.0;  ///< of numbers
  std::vector<std::string_view> choices;  ///< of a choice, in order
  std::string_view word;  ///< may stand instead of a number: "auto", "all"; empty: none
  double wordNumber = 0.0;  ///< the number that it stands for; NaN: no value is set, the default rules
  bool singlePrecision = false;  ///< a float: printed with as few digits as such a one needs
  double (*get)(const RenderSettings&) = nullptr;
  void (*set)(RenderSettings&, double) = nullptr;
  std::string (*getFile)(const RenderSettings&) = nullptr;  ///< of a file, which has no number
  void (*setFile)(RenderSettings&, const std::string&) = nullptr;
};

struct Setting {
  std::string_view key;  ///< technique or stage, dot, name
  SettingValue value;
  std::string_view unit;  ///< empty: a pure number, or none
  std::string_view meaning;  ///< one line, without default and range
  std::string_view source;  ///< keys of shaders/REFERENCES.md; empty: our own
  SettingCost cost = SettingCost::rebuild;
  SettingReaders readers;
  std::string_view usually;  ///< the default, where the command line does not simply take that of RenderSettings
};

std::span<const Setting> allSettings();

/// Null where there is none. Former spellings of keys are understood: formerKey() tells them.
const Setting* findSetting(std::string_view key);
/// The key that is written today for a former spelling; empty where `key` is none.
std::string formerKey(std::string_view key);

/// The value as --set takes it.
std::string printSetting(const Setting& setting, const RenderSettings& settings);
/// Sets it from text. Throws Error(badInput) that begins with `where` and the key, and says what would be right.
void parseSetting(const Setting& setting, RenderSettings& settings, std::string_view value,
                  std::string_view where = "");
/// As a number, not for files. Setting rounds whole numbers, and throws as parseSetting does what is out of range or
/// not finite.
double settingNumber(const Setting& setting, const RenderSettings& settings);
void setSettingNumber(const Setting& setting, RenderSettings& settings, double number);

/// "KEY=VALUE", and what it says where it is used.
struct SettingAssignment {
  const Setting* setting;
  std::string value;
};
/// Throws Error(badInput) that begins with `where` and lists the keys that there are. `only`: those that cost as much;
/// null: all.
SettingAssignment parseAssignment(std::string_view assignment, std::string_view where = "",
                                  const SettingCost* only = nullptr);

/// "1 to 128", "on or off", "flux, published", with the word that may stand instead.
std::string allowedValues(const Setting& setting);
/// The default as --set takes it, or in words.
std::string defaultValue(const Setting& setting);

/// Whether the technique of `settings`, of the light propagation volume its transport, reads the setting.
bool isRead(const Setting& setting, const RenderSettings& settings);
bool isReadBy(const Setting& setting, Technique technique);
bool isReadBy(const Setting& setting, LpvTransport transport);  ///< of the light propagation volume
/// The only transport of the light propagation volume that reads the setting; none where several do, or that technique
/// does not.
std::optional<LpvTransport> onlyTransport(const Setting& setting);

}  // namespace lucerna
