#include "shared/settings_file.hpp"

#include "base/error.hpp"
#include "base/files.hpp"
#include "base/json.hpp"

namespace lucerna::demo {

SettingsFile readSettingsFile(const std::string& file) {
  const std::string name = "--settings " + file;
  const auto json = parseJson<nlohmann::ordered_json>(readFileText(file), name);
  if (!json.is_object()) throwBadInput("{}: expected an object with technique, fidelity, deviations, settings", name);
  SettingsFile result;
  for (const auto& [key, value] : json.items()) {
    const auto fail = [&, &keyName = key](const char* expected) {
      throwBadInput("{}: key \"{}\": expected {}", name, keyName, expected);
    };
    const auto texts = [&, &values = value] {
      if (!values.is_array()) fail("an array of texts");
      std::vector<std::string> list;
      for (const auto& text : values) {
        if (!text.is_string()) fail("an array of texts");
        list.push_back(text.get<std::string>());
      }
      return list;
    };
    if (key == "technique" || key == "fidelity") {
      if (!value.is_string()) fail("text");
      (key == "technique" ? result.technique : result.fidelity) = value.get<std::string>();
    } else if (key == "deviations") {
      result.deviations = texts();
    } else if (key == "settings") {
      result.settings = texts();
    } else if (key == "spp") {
      constexpr std::uint64_t kMost = 4000000000u;  // the maximum of --spp
      if (!value.is_number_unsigned() || value.get<std::uint64_t>() < 1 || value.get<std::uint64_t>() > kMost)
        fail("a whole number from 1 to 4000000000");
      result.spp = value.get<std::uint32_t>();
    } else if (key != "measured") {
      throwBadInput("{}: unknown key \"{}\"; expected one of technique, fidelity, deviations, settings, spp, measured",
                    name, key);
    }
  }
  return result;
}

}  // namespace lucerna::demo
