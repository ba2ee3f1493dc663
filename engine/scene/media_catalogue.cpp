// The catalogue's numbers. Measured liquids were diluted: `millilitres` of the substance in 23 litres of water
// [Narasimhan2006]. Single scattering makes coefficients proportional to concentration, so the undiluted ones are 23000
// / millilitres times the measured ones.
#include "scene/media_catalogue.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <utility>

namespace lucerna {

namespace {

/// [VPT2024, table 4.1]; ior from the text below it.
struct Published {
  const char* name;
  glm::dvec3 scattering, absorption, anisotropy;
  double ior;
  bool measured;  ///< after [Narasimhan2006]; else invented by the author
};

const Published kPublished[] = {
    {"milk", {18.2052, 20.3826, 22.3698}, {0.00153, 0.00460, 0.01993}, {0.750, 0.714, 0.681}, 1.33, true},
    {"espresso", {7.78262, 8.13050, 8.53875}, {4.79838, 6.57512, 8.84925}, {0.907, 0.896, 0.880}, 1.33, true},
    {"sprite", {0.00011, 0.00014, 0.00014}, {0.00189, 0.00183, 0.00200}, {0.943, 0.953, 0.952}, 1.33, true},
    {"coca cola", {0.00254, 0.00299, 0.0}, {0.10014, 0.16503, 0.24680}, {0.965, 0.972, 0.0}, 1.33, true},
    {"apple juice", {0.00257, 0.00311, 0.00413}, {0.01296, 0.02374, 0.05218}, {0.947, 0.949, 0.945}, 1.33, true},
    {"grape juice", {0.00138, 0.0, 0.0}, {0.10404, 0.23958, 0.29325}, {0.961, 0.0, 0.0}, 1.33, true},
    {"chardonnay", {0.00021, 0.00033, 0.00048}, {0.01078, 0.01186, 0.02400}, {0.914, 0.958, 0.975}, 1.33, true},
    {"budweiser", {0.00029, 0.00055, 0.00059}, {0.01149, 0.02491, 0.05579}, {0.917, 0.956, 0.982}, 1.33, true},
    {"emerald", {0.18, 0.07, 0.03}, {0.97, 0.061, 1.45}, {0.943, 0.953, 0.952}, 1.52, false},
    {"ruby", {0.18, 0.07, 0.03}, {0.061, 0.97, 1.45}, {0.943, 0.953, 0.952}, 1.77, false},
    {"sapphire", {0.18, 0.07, 0.03}, {0.97, 1.45, 0.061}, {0.943, 0.953, 0.952}, 1.77, false},
    {"glass", {0.00011, 0.00014, 0.00014}, {0.00189, 0.00183, 0.00200}, {0.943, 0.953, 0.952}, 1.5, false},
};

/// [Narasimhan2006]: millilitres in 23 litres of water; extinction and scattering of that dilution in 1e-2/mm.
struct Measured {
  const char* name;
  double millilitres;
  glm::dvec3 extinction, scattering, anisotropy;
};

const Measured kMeasured[] = {
    {"lowfat milk", 16, {.9126, 1.0748, 1.2500}, {.9124, 1.0744, 1.2492}, {.932, .902, .859}},
    {"reduced milk", 18, {1.0750, 1.2213, 1.3941}, {1.0748, 1.2209, 1.3931}, {.819, .797, .746}},
    {"regular milk", 15, {1.1874, 1.3296, 1.4602}, {1.1873, 1.3293, 1.4589}, {.750, .714, .681}},
    {"espresso", 8, {.4376, .5115, .6048}, {.2707, .2828, .2970}, {.907, .896, .880}},
    {"mint mocha coffee", 6, {.1900, .2600, .3500}, {.0916, .1081, .1460}, {.910, .907, .914}},
    {"lowfat soy milk", 16, {.1419, .1625, .2740}, {.1418, .1620, .2715}, {.850, .853, .842}},
    {"regular soy milk", 12, {.2434, .2719, .4597}, {.2433, .2714, .4563}, {.873, .858, .832}},
    {"lowfat chocolate milk", 10, {.4282, .5014, .5791}, {.4277, .4998, .5723}, {.934, .927, .916}},
    {"regular chocolate milk", 16, {.7359, .9172, 1.0688}, {.7352, .9142, 1.0588}, {.862, .838, .806}},
    {"coke", 1600, {.7143, 1.1688, 1.7169}, {.0177, .0208, 0}, {.965, .972, 0}},
    {"pepsi", 1600, {.6433, .9990, 1.4420}, {.0058, .0141, 0}, {.926, .979, 0}},
    {"sprite", 15000, {.1299, .1283, .1395}, {.0069, .0089, .0089}, {.943, .953, .952}},
    {"gatorade", 1500, {.4009, .4185, .4324}, {.2392, .2927, .3745}, {.933, .933, .935}},
    {"chardonnay", 3300, {.1577, .1748, .3512}, {.0030, .0047, .0069}, {.914, .958, .975}},
    {"white zinfandel", 3300, {.1763, .2370, .2913}, {.0031, .0048, .0066}, {.919, .943, .972}},
    {"merlot", 1500, {.7639, 1.6429, 1.9196}, {.0053, 0, 0}, {.974, 0, 0}},
    {"budweiser", 2900, {.1486, .3210, .7360}, {.0037, .0069, .0074}, {.917, .956, .982}},
    {"coors light", 1000, {.0295, .0663, .1521}, {.0027, .0055, 0}, {.918, .966, 0}},
    {"clorox", 1200, {.1600, .2500, .3300}, {.1425, .1723, .1928}, {.912, .905, .892}},
    {"apple juice", 1800, {.1215, .2101, .4407}, {.0201, .0243, .0323}, {.947, .949, .945}},
    {"cranberry juice", 1500, {.2700, .6300, .8300}, {.0128, .0155, .0196}, {.947, .951, .974}},
    {"grape juice", 1200, {.5500, 1.2500, 1.5300}, {.0072, 0, 0}, {.961, 0, 0}},
    {"ruby grapefruit juice", 240, {.2513, .3517, .4305}, {.1617, .1606, .1669}, {.929, .929, .931}},
    {"white grapefruit juice", 160, {.3609, .3800, .5632}, {.3513, .3669, .5237}, {.548, .545, .565}},
    {"shampoo", 300, {.0288, .0710, .0952}, {.0104, .0114, .0147}, {.910, .905, .920}},
    {"strawberry shampoo", 300, {.0217, .0788, .1022}, {.0028, .0032, .0033}, {.927, .935, .994}},
    {"head & shoulders shampoo", 240, {.3674, .4527, .5211}, {.2791, .2890, .3086}, {.911, .896, .884}},
};

constexpr double kWater = 23000.0;  // ml
constexpr double kTableUnit = 0.01;  // 1/mm

std::vector<CatalogueMedium> makeCatalogue() {
  std::vector<CatalogueMedium> catalogue;
  for (const Published& p : kPublished)
    catalogue.push_back({p.name, p.scattering, p.absorption, p.anisotropy, p.ior, true,
                         p.measured ? "VPT2024 table 4.1, after Narasimhan2006" : "VPT2024 table 4.1, invented there"});
  for (const Measured& m : kMeasured) {
    const double undiluted = kTableUnit * kWater / m.millilitres;
    catalogue.push_back({fmt::format("measured {}", m.name), undiluted * m.scattering,
                         undiluted * (m.extinction - m.scattering), m.anisotropy, 1.33, false,
                         fmt::format("Narasimhan2006, {:g} ml in 23 l of water", m.millilitres)});
  }
  return catalogue;
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

/// Keeps only letters, in lower case: "Coca_Cola.001" is "cocacola".
std::string lettersOf(std::string_view text) {
  std::string result = lower(text);
  std::erase_if(result, [](char c) { return c < 'a' || c > 'z'; });
  return result;
}

/// Synonyms for the original's media, letters only; the Czech ones without accents.
constexpr std::pair<const char*, const char*> kOtherWords[] = {
    {"mleko", "milk"},        {"kava", "espresso"},
    {"coffee", "espresso"},   {"coke", "coca cola"},
    {"cola", "coca cola"},    {"jablecnydzus", "apple juice"},
    {"juice", "apple juice"}, {"hroznovydzus", "grape juice"},
    {"grape", "grape juice"}, {"wine", "chardonnay"},
    {"pivo", "budweiser"},    {"beer", "budweiser"},
    {"smaragd", "emerald"},   {"rubin", "ruby"},
    {"safir", "sapphire"},    {"sklo", "glass"},
};

}  // namespace

glm::dvec3 CatalogueMedium::albedo() const {
  const glm::dvec3 t = extinction();
  glm::dvec3 result(0.0);
  for (int c = 0; c < 3; ++c) result[c] = t[c] > 0.0 ? scattering[c] / t[c] : 0.0;
  return result;
}

glm::dvec3 CatalogueMedium::meanFreePath() const {
  const glm::dvec3 t = extinction();
  glm::dvec3 result(0.0);
  for (int c = 0; c < 3; ++c) result[c] = t[c] > 0.0 ? 1.0 / t[c] : std::numeric_limits<double>::infinity();
  return result;
}

const std::vector<CatalogueMedium>& mediaCatalogue() {
  static const std::vector<CatalogueMedium> catalogue = makeCatalogue();
  return catalogue;
}

const CatalogueMedium* findCatalogueMedium(std::string_view name) {
  const std::string wanted = lower(name);
  const auto& catalogue = mediaCatalogue();
  const auto found =
      std::find_if(catalogue.begin(), catalogue.end(), [&](const CatalogueMedium& m) { return m.name == wanted; });
  return found == catalogue.end() ? nullptr : &*found;
}

const CatalogueMedium* resemblingMedium(std::string_view materialName) {
  const std::string name = lettersOf(materialName);
  const CatalogueMedium* best = nullptr;
  std::size_t bestLength = 0, bestEnd = 0;
  const auto consider = [&](const std::string& word, const CatalogueMedium* medium) {
    const std::size_t place = name.rfind(word);
    if (place == std::string::npos) return;
    const std::size_t end = place + word.size();
    if (end < bestEnd || (end == bestEnd && word.size() < bestLength)) return;
    best = medium, bestLength = word.size(), bestEnd = end;
  };
  for (const CatalogueMedium& medium : mediaCatalogue())
    if (medium.published) consider(lettersOf(medium.name), &medium);
  for (const auto& [word, medium] : kOtherWords) consider(word, findCatalogueMedium(medium));
  return best;
}

Medium mediumOf(const CatalogueMedium& entry, double millimetresPerUnit) {
  Medium medium;
  medium.name = entry.name;
  medium.scattering = glm::vec3(entry.scattering * millimetresPerUnit);
  medium.absorption = glm::vec3(entry.absorption * millimetresPerUnit);
  medium.anisotropy = glm::vec3(entry.anisotropy);
  return medium;
}

}  // namespace lucerna
