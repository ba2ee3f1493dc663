// The table of settings: every entry is parsed, printed, documented and kept in a place of its own; what is wrong is
// refused with what would be right.
#include "base/error.hpp"
#include "base/files.hpp"
#include "irradiance_cache/settings.hpp"
#include "render/settings.hpp"
#include "render/techniques.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <regex>
#include <set>
#include <sstream>

namespace lucerna {
namespace {

using test::badInputMessage;

bool isNumber(const Setting& setting) {
  return setting.value.type == SettingType::integer || setting.value.type == SettingType::real;
}

/// Every value of a choice or switch; of a number its bounds, something between them and the word.
std::vector<std::string> someValues(const Setting& setting) {
  const SettingValue& value = setting.value;
  switch (value.type) {
    case SettingType::boolean: return {"on", "off"};
    case SettingType::choice: return {value.choices.begin(), value.choices.end()};
    case SettingType::file: return {"a file.lit", "b"};
    case SettingType::integer:
    case SettingType::real: break;
  }
  RenderSettings settings;
  std::vector<std::string> texts;
  for (const double number : {value.least, 0.5 * (value.least + value.most), value.most}) {
    setSettingNumber(setting, settings, number);
    texts.push_back(printSetting(setting, settings));
  }
  if (!value.word.empty()) texts.emplace_back(value.word);
  return texts;
}

/// All settings as text.
std::vector<std::string> printed(const RenderSettings& settings) {
  std::vector<std::string> texts;
  for (const Setting& setting : allSettings()) texts.push_back(printSetting(setting, settings));
  return texts;
}

TEST(Settings, KeysAreDistinctAndEveryEntryIsWhole) {
  std::set<std::string_view> keys;
  for (const Setting& setting : allSettings()) {
    const std::string key(setting.key);
    EXPECT_TRUE(keys.insert(setting.key).second) << key;
    EXPECT_TRUE(std::regex_match(key, std::regex("exposure|[a-z]+\\.[a-z-]+"))) << key;
    EXPECT_FALSE(setting.meaning.empty()) << key;
    EXPECT_EQ(setting.meaning.find('\n'), std::string_view::npos) << key;
    EXPECT_TRUE(std::ranges::any_of(
        allTechniques(),
        [&](const TechniqueEntry& technique) { return readWith(setting, technique.name).has_value(); }))
        << key << " is read by nothing";
    if (!setting.with.empty()) {  // it names a value of another setting
      RenderSettings settings;
      const SettingAssignment needed = parseAssignment(setting.with);
      EXPECT_NO_THROW(parseSetting(*needed.setting, settings, needed.value)) << key;
      EXPECT_EQ(needed.setting->group, setting.group) << key;
    }
    EXPECT_TRUE(!isNumber(setting) || setting.value.least < setting.value.most) << key;
    EXPECT_TRUE(setting.value.type != SettingType::choice || setting.value.choices.size() > 1) << key;
    EXPECT_FALSE(setting.value.type == SettingType::file ? setting.usually.empty() : defaultValue(setting).empty())
        << key;
  }
  EXPECT_GT(keys.size(), 50u);
}

// A setting that is parsed is printed as it was written, and changes its own place alone.
TEST(Settings, EachIsParsedPrintedAndKeptInItsOwnPlace) {
  const std::vector<std::string> usual = printed({});
  std::size_t index = 0;
  for (const Setting& setting : allSettings()) {
    std::set<std::string> seen;
    for (const std::string& text : someValues(setting)) {
      RenderSettings settings;
      parseSetting(setting, settings, text);
      EXPECT_EQ(printSetting(setting, settings), text) << setting.key;
      seen.insert(printSetting(setting, settings));
      std::vector<std::string> others = printed(settings), expected = usual;
      others.erase(others.begin() + static_cast<std::ptrdiff_t>(index));
      expected.erase(expected.begin() + static_cast<std::ptrdiff_t>(index));
      EXPECT_EQ(others, expected) << setting.key << "=" << text << " changes another setting";
      if (setting.value.type == SettingType::file) continue;
      RenderSettings byNumber;
      setSettingNumber(setting, byNumber, settingNumber(setting, settings));
      EXPECT_EQ(printSetting(setting, byNumber), text) << setting.key;
    }
    EXPECT_GT(seen.size(), 1u) << setting.key << " cannot be changed";
    ++index;
  }
}

TEST(Settings, WhatIsWrongIsRefusedWithWhatWouldBeRight) {
  for (const Setting& setting : allSettings()) {
    if (setting.value.type == SettingType::file) continue;
    const std::string key(setting.key);
    std::vector<std::string> wrong{"", "nan", "inf", "-inf", "nonsense", "1e999", " 1", "1 ", "0x10"};
    if (isNumber(setting)) {
      wrong.push_back(fmt::format("{}", setting.value.least - 1.0));
      wrong.push_back(fmt::format("{}", setting.value.most * 2.0 + 1.0));
    }
    if (setting.value.type == SettingType::integer) wrong.insert(wrong.end(), {"1.5", "2e0"});
    for (const std::string& text : wrong) {
      RenderSettings settings;
      const std::string message = badInputMessage([&] { parseSetting(setting, settings, text, "--set "); });
      EXPECT_TRUE(message.starts_with("--set " + key + ": '" + text + "' is ")) << message;
      EXPECT_NE(message.find(allowedValues(setting).substr(0, 3)), std::string::npos) << message;
      EXPECT_EQ(printed(settings), printed({})) << key << "=" << text << " changed something";
    }
    RenderSettings settings;
    const bool nanMeansUnset = !setting.value.word.empty() && std::isnan(setting.value.wordNumber);
    if (!nanMeansUnset) {
      EXPECT_NE(badInputMessage([&] {
                  setSettingNumber(setting, settings, std::numeric_limits<double>::quiet_NaN());
                }).find(key),
                std::string::npos);
    }
    EXPECT_NE(badInputMessage([&] {
                setSettingNumber(setting, settings, std::numeric_limits<double>::infinity());
              }).find(key),
              std::string::npos);
    const double below = setting.value.least - 1.0, beyond = 2.0 * setting.value.most + 1.0;
    for (const double number : {below, beyond}) {
      if (!setting.value.word.empty() && number == setting.value.wordNumber) continue;  // it stands for the word
      EXPECT_NE(badInputMessage([&] { setSettingNumber(setting, settings, number); }).find(key), std::string::npos)
          << number;
    }
    EXPECT_EQ(printed(settings), printed({})) << key;
  }
}

TEST(Settings, UnknownKeysAreRefusedWithTheNearest) {
  const std::string message = badInputMessage([] { parseAssignment("lpv.cels=3", "--set "); });
  EXPECT_TRUE(message.starts_with("--set lpv.cels=3: unknown key; nearest: lpv.cells, ")) << message;
  EXPECT_LT(message.size(), 150u) << message;
  EXPECT_NE(message.find("info --settings"), std::string::npos) << message;
  // A key without its technique's name, with another's, and with two letters swapped.
  for (const char* wrong : {"cells=3", "rsm.cells=3", "lpv.clels=3"})
    EXPECT_NE(badInputMessage([&] { parseAssignment(wrong); }).find("lpv.cells"), std::string::npos) << wrong;
  for (const char* wrong : {"", "=", "=3", "lpv.cells"})
    EXPECT_NE(badInputMessage([&] { parseAssignment(wrong); }).find("key=value"), std::string::npos) << wrong;
  // Of a radiosity solution's alone.
  const SettingCost only = SettingCost::solution;
  EXPECT_EQ(parseAssignment("radiosity.edge=0.5", "", &only).value, "0.5");
  EXPECT_EQ(badInputMessage([&] { parseAssignment("radiosity.mesh=on", "", &only); }).find("lpv.cells"),
            std::string::npos);
}

// A technique's settings begin with its name (the irradiance cache's with cache); none reads another's.
TEST(Settings, AreReadByTheirTechnique) {
  const std::map<std::string, std::string_view> owners{
      {"lpv", "lpv"}, {"cache", "irradiance-cache"}, {"radiosity", "radiosity"}, {"path", "path"}};
  for (const Setting& setting : allSettings()) {
    const auto owner = owners.find(std::string(setting.key.substr(0, setting.key.find('.'))));
    if (owner != owners.end()) { EXPECT_EQ(onlyTechnique(setting), owner->second) << setting.key; }
  }
  RenderSettings settings;
  EXPECT_EQ(settings.technique, "irradiance-cache");
  EXPECT_TRUE(isRead(*findSetting("cache.samples"), settings));
  settings.of<IrradianceCacheSettings>().transport = CacheTransport::gather;
  EXPECT_FALSE(isRead(*findSetting("cache.samples"), settings));
  EXPECT_EQ(readWith(*findSetting("cache.samples"), "irradiance-cache"), "cache.transport=rays");
  EXPECT_EQ(readWith(*findSetting("cache.bounce-cells"), "irradiance-cache"), "cache.transport=gather");
  EXPECT_EQ(readWith(*findSetting("cache.cells"), "irradiance-cache"), "");
  EXPECT_EQ(readWith(*findSetting("cache.cells"), "lpv"), std::nullopt);
  EXPECT_EQ(readWith(*findSetting("rsm.size"), "irradiance-cache"), "cache.transport=gather");
  EXPECT_EQ(readWith(*findSetting("rsm.size"), "lpv"), "");
  EXPECT_EQ(onlyTechnique(*findSetting("rsm.samples")), "rsm");
  EXPECT_EQ(onlyTechnique(*findSetting("rsm.size")), std::nullopt);
}

TEST(Settings, SourcesAreInTheListOfReferences) {
  const std::string references = readFileText(LUCERNA_SOURCE_DIR "/shaders/REFERENCES.md");
  for (const Setting& setting : allSettings()) {
    if (setting.source.empty()) continue;
    std::smatch match;
    const std::string source(setting.source);
    ASSERT_TRUE(std::regex_match(source, match, std::regex("\\[([A-Za-z]+[0-9]*)(, [^\\]]*)?\\]")))
        << setting.key << " " << source;
    EXPECT_NE(references.find("- [" + match[1].str() + "]"), std::string::npos) << setting.key << " " << source;
  }
}

// Documents name settings as they are written today.
TEST(Settings, DocumentsNameNoUnknownKey) {
  const std::regex assignment("`((lpv|cache|rsm|radiosity|path|shadow|texture|frame)\\.[a-z-]+)=");
  for (const char* folder : {"lpv", "irradiance_cache", "rsm", "radiosity", "forward", "pathtracer", "measure"}) {
    std::ifstream file(std::string(LUCERNA_SOURCE_DIR "/engine/") + folder + "/README.md");
    for (std::string line; std::getline(file, line);)
      for (std::sregex_iterator match(line.begin(), line.end(), assignment), end; match != end; ++match) {
        const std::string key = (*match)[1];
        const std::string text = readFileText(LUCERNA_SOURCE_DIR "/docs/settings.md");
        EXPECT_NE(text.find("`" + key + "`"), std::string::npos)
            << folder << "/README.md: " << key << " is neither a setting nor a deviation";
      }
  }
}

}  // namespace
}  // namespace lucerna
