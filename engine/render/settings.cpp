#include "render/settings.hpp"

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/nearest_words.hpp"
#include "render/techniques.hpp"

#include <fmt/ranges.h>

#include <algorithm>

namespace lucerna {

namespace {

/// Of shadow maps, textures and the frame: of no single technique.
std::span<const Setting> sharedSettings() {
  using namespace setting_values;
  constexpr auto rebuild = SettingCost::rebuild, uniform = SettingCost::uniform;
  static const std::vector<Setting> table{
      {"shadow.transport", choice(FRAME_FIELD(shadows)), "",
       "occlusion of sun and lamps: map, by shadow maps; rays, exactly, with penumbrae over a pixel's "
       "samples",
       "", rebuild, "", "", "shadows"},
      {"shadow.size", number(FRAME_FIELD(shadow.size), 1, 16384), "texels",
       "side of the sun's shadow map, of each cascade", "", rebuild, "shadow.transport=map", "", "shadows"},
      {"shadow.cascades",
       number(FRAME_FIELD(shadow.cascades.cascades), 1, SUN_MAX_CASCADES, "auto", SunCascadeSettings::kAuto), "",
       "shadow maps of the sun along the view; 1: one for the whole scene; auto: one, unless a mesh, or a "
       "part that is large in view, has fewer than 4 of its texels",
       "[Zhang2006]", rebuild, "shadow.transport=map", "", "shadows"},
      {"shadow.split", number(FRAME_FIELD(shadow.cascades.split), 0.0, 1.0), "",
       "how cascades divide the view's depth: 0 uniformly, 1 logarithmically", "[Zhang2006, section 3.2]", rebuild,
       "shadow.transport=map", "", "shadows"},
      {"shadow.filter", choice(FRAME_FIELD(shadow.filter)), "",
       "of shadow maps: tent, 3x3 texels; pcss, penumbrae of the sun's disc and of lamps' balls, too, as wide as what "
       "casts them is far",
       "[Fernando2005]", rebuild, "shadow.transport=map", "", "shadows"},
      {"shadow.taps", number(FRAME_FIELD(shadow.taps), 2, 256), "a frame",
       "lookups in a penumbra; half as many look for what casts it", "[Fernando2005]", rebuild, "shadow.filter=pcss",
       "", "shadows"},
      {"shadow.lamps", number(FRAME_FIELD(lights.shadows), 0, LIGHTS_MAX_SHADOWS), "of a kind",
       "spots, and omnidirectional lights, with shadow maps, at most: those that light the scene most; rays find the "
       "shadows of the others",
       "", rebuild, "", "", "shadows"},
      {"shadow.spot-size", number(FRAME_FIELD(lights.spotSize), 1, 16384), "texels",
       "side of a spot light's shadow map", "", rebuild, "shadow.transport=map", "", "shadows"},
      {"shadow.point-size", number(FRAME_FIELD(lights.pointSize), 1, 16384), "texels",
       "side of each face of an omnidirectional light's shadow map", "", rebuild, "shadow.transport=map", "",
       "shadows"},
      {"texture.anisotropy", number(FRAME_FIELD(textures.anisotropy), 1.0, 16.0), "",
       "anisotropic filtering of visible surfaces, at most; 1 without mipmaps", "", rebuild, "", "", "textures"},
      {"texture.mipmaps", boolean(FRAME_FIELD(textures.mipmaps)), "",
       "smaller versions of textures at a distance; off: textures flicker", "[LPV2015]", rebuild, "", "", "textures"},
      {"picture.samples", number(FRAME_FIELD(pixelSamples), 1, 1024), "per pixel",
       "frames of one view that are averaged, each for another point of every pixel", "", rebuild, "",
       "16; where frames are timed 1", "textures"},
      {"picture.multisamples", number(FRAME_FIELD(multisamples), 1, 64), "per pixel",
       "points of each frame at which surfaces are told apart, at least; each surface of a pixel is shaded once", "",
       rebuild, "", "", "textures"},
      {"picture.filter", choice(FRAME_FIELD(filter)), "",
       "weight of light around a pixel's centre: box: the pixel's area; gaussian: standard deviation 1/2, "
       "to "
       "1.5 pixels; blackman-harris: to 1.5 pixels; centre: one point",
       "[Ernst2006]", rebuild, "", "", "all"},
      {"picture.motion-samples", number(FRAME_FIELD(motionSamples), 1, 64, "auto"), "per frame",
       "of a pixel's samples, those that each frame draws while the view or the scene moves; auto: all after the first "
       "take half of its time, or what is left of 1/60 s",
       "", uniform, "", "", "textures"},
      {"picture.reprojection", boolean(FRAME_FIELD(reprojection)), "",
       "while the view moves, earlier frames smooth edges too, and noise", "[Salvi2016]", uniform, "", "", "all"},
      {"frame.reuse", boolean(FRAME_FIELD(reuse)), "",
       "reuse unchanged results of the previous frame: maps, volume, cache", "", uniform, "", "", "textures"},
      {"exposure", optionalNumber(FRAME_FIELD(exposure), 1e-12, 1e12), "", "multiplies radiance before tone mapping",
       "", uniform, "", "auto: the scene's", "all"},
  };
  return table;
}

}  // namespace

const std::vector<Setting>& allSettings() {
  static std::vector<Setting> all;
  static std::size_t techniques = 0;
  if (techniques == allTechniques().size()) return all;
  techniques = allTechniques().size();
  all.clear();
  for (const TechniqueEntry& technique : allTechniques())
    for (Setting setting : technique.settings) {
      if (setting.group.empty()) setting.group = technique.name;
      all.push_back(setting);
    }
  const auto shared = sharedSettings();
  all.insert(all.end(), shared.begin(), shared.end());
  return all;
}

const Setting* findSetting(std::string_view key) {
  const auto found =
      std::find_if(allSettings().begin(), allSettings().end(), [&](const Setting& s) { return s.key == key; });
  return found == allSettings().end() ? nullptr : &*found;
}

SettingAssignment parseAssignment(std::string_view assignment, std::string_view where, const SettingCost* only) {
  const auto equals = assignment.find('=');
  if (equals == std::string_view::npos || equals == 0) throwBadInput("{}{}: expected key=value", where, assignment);
  const Setting* setting = findSetting(assignment.substr(0, equals));
  if (setting && (!only || setting->cost == *only)) return {setting, std::string(assignment.substr(equals + 1))};
  std::vector<std::string_view> keys;
  for (const Setting& s : allSettings())
    if (!only || s.cost == *only) keys.push_back(s.key);
  throwBadInput("{}{}: unknown key; nearest: {} (lucerna info --settings lists all)", where, assignment,
                nearestList(assignment.substr(0, equals), keys));
}

namespace {

/// Values without which a setting that was given is not read, where no other was asked for: that of the first.
void chooseImplied(RenderSettings& settings, const std::vector<const Setting*>& given) {
  std::vector<const Setting*> chosen = given;
  for (const Setting* setting : given) {
    const auto with = readWith(*setting, settings.technique);
    if (!with || with->empty()) continue;
    const SettingAssignment implied = parseAssignment(*with);
    if (std::ranges::find(chosen, implied.setting) != chosen.end()) continue;
    if (!isRead(*setting, settings)) logInfo("{}: using {}, the only one that reads it", setting->key, *with);
    parseSetting(*implied.setting, settings, implied.value);
    chosen.push_back(implied.setting);
  }
}

}  // namespace

void applySettings(RenderSettings& settings, const std::vector<std::string>& assignments, std::string_view where) {
  std::vector<const Setting*> given;
  for (const std::string& assignment : assignments) {
    const auto [setting, value] = parseAssignment(assignment, where);
    parseSetting(*setting, settings, value, where);
    given.push_back(setting);
  }
  chooseImplied(settings, given);
  std::string unread;
  for (const Setting* setting : given) {
    const auto with = readWith(*setting, settings.technique);
    if (!with) unread += (unread.empty() ? "" : ", ") + std::string(setting->key);
    else if (!isRead(*setting, settings)) {
      const SettingAssignment needed = parseAssignment(*with);
      logWarning("{}{}: {}={} does not use it, {} does", where, setting->key, needed.setting->key,
                 printSetting(*needed.setting, settings), needed.value);
    }
  }
  if (!unread.empty()) logWarning("{}{}: technique {} does not use it", where, unread, settings.technique);
}

std::optional<std::string_view> readWith(const Setting& setting, std::string_view technique) {
  if (setting.group == "all") return "";
  if (setting.group == technique) return setting.with;
  for (const TechniqueEntry::Shared& shared : techniqueNamed(technique).reads)
    if (shared.group == setting.group) return shared.with;
  return {};
}

bool isRead(const Setting& setting, const RenderSettings& settings) {
  const auto with = readWith(setting, settings.technique);
  if (!with || with->empty()) return with.has_value();
  const SettingAssignment needed = parseAssignment(*with);
  return printSetting(*needed.setting, settings) == needed.value;
}

std::optional<std::string_view> onlyTechnique(const Setting& setting) {
  std::optional<std::string_view> only;
  for (const TechniqueEntry& technique : allTechniques()) {
    if (!readWith(setting, technique.name)) continue;
    if (only) return {};
    only = technique.name;
  }
  return only;
}

}  // namespace lucerna
