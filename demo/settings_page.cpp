#include "settings_page.hpp"

#include "render/deviations.hpp"
#include "render/settings.hpp"
#include "render/techniques.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace lucerna::demo {

namespace {

std::vector<std::string_view> techniquesOf(const Setting& setting) {
  std::vector<std::string_view> names;
  for (const TechniqueEntry& technique : allTechniques())
    if (readWith(setting, technique.name)) names.push_back(technique.name);
  return names;
}

/// The value without which a technique does not read it: "cache.transport=gather"; empty without one.
std::string_view conditionOf(const Setting& setting) {
  for (const std::string_view technique : techniquesOf(setting))
    if (const std::string_view with = *readWith(setting, technique); !with.empty()) return with;
  return "";
}

/// Escapes the characters that would end a table cell.
std::string cell(std::string_view text) {
  std::string escaped;
  for (const char c : text) escaped += c == '|' ? std::string("\\|") : std::string(1, c);
  return escaped;
}

std::string readers(const Setting& setting) {
  const std::vector<std::string_view> techniques = techniquesOf(setting);
  const std::string_view with = conditionOf(setting);
  return (techniques.size() == allTechniques().size() ? "all" : fmt::format("{}", fmt::join(techniques, ", "))) +
         (with.empty() ? "" : fmt::format(" (with {})", with));
}

}  // namespace

std::string settingsPage() {
  std::string text =
      "# Settings\n\n"
      "Made by `lucerna info --settings` from the tables of the techniques (engine/NAME/technique.cpp) and of the "
      "frame\n"
      "(engine/render/settings.cpp); a test compares them.\n\n"
      "Change a setting by `--set KEY=VALUE` or in a settings file (`--settings FILE`: a JSON object of `technique`,\n"
      "`fidelity`, `deviations` and `settings`). A setting that the technique does not read causes a warning.\n"
      "Cost of a change: *uniform*, it takes effect in the next frame; *rebuild*, programs are compiled and textures\n"
      "allocated anew; *solution*, radiosity is solved anew. Sources are those of shaders/REFERENCES.md.\n";
  std::string_view group;
  for (const Setting& setting : allSettings()) {
    const std::string_view stage = setting.key.substr(0, setting.key.find('.'));
    if (stage != group)
      text += fmt::format(
          "\n## {}\n\n| Key | Values | Default | Unit | Meaning | Read by | Cost of a change | Source "
          "|\n|---|---|---|---|---|---|---|---|\n",
          stage);
    group = stage;
    text += fmt::format("| `{}` | {} | {} | {} | {} | {} | {} | {} |\n", setting.key, cell(allowedValues(setting)),
                        cell(defaultValue(setting)), setting.unit, cell(setting.meaning), readers(setting),
                        nameOf(setting.cost), setting.source);
  }
  text +=
      "\n## Deviations\n\n"
      "Differences of the published originals, each with a switch: `--deviation NAME=on|off`. A star marks those\n"
      "switched on by `--fidelity original` (the same as `thesis`), a plus those switched on by `demo`, the program\n"
      "published with the thesis on light propagation. The README.md of each technique has formulas, sources and\n"
      "measured effects.\n"
      "\n| Name | | Meaning |\n|---|---|---|\n";
  for (const Deviation& deviation : allDeviations())
    text += fmt::format("| `{}` | {} | {} |\n", deviation.name,
                        std::string(deviation.inOriginal() ? "*" : "") + (deviation.inDemo() ? "+" : ""),
                        cell(deviation.meaning));
  return text;
}

nlohmann::ordered_json settingsJson() {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Setting& setting : allSettings()) {
    nlohmann::ordered_json entry = {{"key", setting.key}, {"type", nameOf(setting.value.type)}};
    if (setting.value.type == SettingType::integer || setting.value.type == SettingType::real) {
      entry["least"] = setting.value.least;
      entry["most"] = setting.value.most;
    }
    if (!setting.value.choices.empty()) entry["choices"] = setting.value.choices;
    if (!setting.value.word.empty()) entry["word"] = setting.value.word;
    entry["unit"] = setting.unit;
    entry["default"] = defaultValue(setting);
    entry["meaning"] = setting.meaning;
    entry["source"] = setting.source;
    entry["cost"] = nameOf(setting.cost);
    entry["techniques"] = techniquesOf(setting);
    entry["with"] = conditionOf(setting);
    list.push_back(entry);
  }
  return list;
}

}  // namespace lucerna::demo
