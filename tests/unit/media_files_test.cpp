// Media from files: the catalogue against what was published, density grids, the VPT original's scene JSON, the keys
// for media in our own, drafts.
#include "base/error.hpp"
#include "base/files.hpp"
#include "scene/density_file.hpp"
#include "scene/media_catalogue.hpp"
#include "scene/original_scene_file.hpp"
#include "scene/scene.hpp"
#include "support/contains.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>
#include <set>
#include <sstream>

namespace lucerna {
namespace {

using test::badInputMessage;
using test::contains;
using test::TempFolder;

void expectVector(const glm::dvec3& measured, const glm::dvec3& expected, double relative, const std::string& what) {
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(measured[c], expected[c], relative * std::abs(expected[c])) << what << ", channel " << c;
}

// ---------------------------------------------------------------------------------------------------- catalogue

TEST(MediaCatalogue, TheOriginalsTwelveStandFirstAsPrinted) {
  const auto& catalogue = mediaCatalogue();
  ASSERT_EQ(catalogue.size(), 12u + 27u);
  const char* names[] = {"milk",       "espresso",  "sprite",  "coca cola", "apple juice", "grape juice",
                         "chardonnay", "budweiser", "emerald", "ruby",      "sapphire",    "glass"};
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_EQ(catalogue[i].name, names[i]);
    EXPECT_TRUE(catalogue[i].published);
  }
  const CatalogueMedium& milk = *findCatalogueMedium("Milk");
  EXPECT_EQ(milk.scattering, glm::dvec3(18.2052, 20.3826, 22.3698));
  EXPECT_EQ(milk.absorption, glm::dvec3(0.00153, 0.00460, 0.01993));
  EXPECT_EQ(milk.anisotropy, glm::dvec3(0.750, 0.714, 0.681));
  EXPECT_EQ(milk.ior, 1.33);
  EXPECT_EQ(findCatalogueMedium("budweiser")->absorption.z, 0.05579);  // the printed figure; measured: 0.05779
  EXPECT_EQ(findCatalogueMedium("emerald")->ior, 1.52);
  EXPECT_EQ(findCatalogueMedium("ruby")->ior, 1.77);
  EXPECT_EQ(findCatalogueMedium("sapphire")->ior, 1.77);
  EXPECT_EQ(findCatalogueMedium("glass")->ior, 1.5);
  EXPECT_EQ(findCatalogueMedium("ruby")->absorption, glm::dvec3(0.061, 0.97, 1.45));
  EXPECT_EQ(findCatalogueMedium("coca cola")->anisotropy, glm::dvec3(0.965, 0.972, 0.0));
  EXPECT_EQ(findCatalogueMedium("tea"), nullptr);
}

TEST(MediaCatalogue, EveryMediumIsPhysicalAndNamed) {
  std::set<std::string> names;
  for (const CatalogueMedium& m : mediaCatalogue()) {
    EXPECT_TRUE(names.insert(m.name).second) << m.name;
    EXPECT_FALSE(m.source.empty()) << m.name;
    EXPECT_GE(m.ior, 1.0) << m.name;
    for (int c = 0; c < 3; ++c) {
      EXPECT_GE(m.scattering[c], 0.0) << m.name;
      EXPECT_GE(m.absorption[c], 0.0) << m.name;
      EXPECT_LT(std::abs(m.anisotropy[c]), 1.0) << m.name;
      EXPECT_LE(m.albedo()[c], 1.0) << m.name;
      EXPECT_NEAR(m.meanFreePath()[c] * m.extinction()[c], 1.0, 1e-12) << m.name;
    }
  }
}

TEST(MediaCatalogue, ThePublishedLiquidsAreTheMeasuredOnesUndiluted) {
  // Seven of the original's eight liquids, to a unit of the last digit printed there (the eighth is mistyped in blue).
  // Milk and espresso have six digits.
  const std::pair<const char*, const char*> same[] = {
      {"milk", "measured regular milk"},       {"espresso", "measured espresso"},
      {"sprite", "measured sprite"},           {"coca cola", "measured coke"},
      {"apple juice", "measured apple juice"}, {"grape juice", "measured grape juice"},
      {"chardonnay", "measured chardonnay"}};
  for (const auto& [published, measured] : same) {
    const CatalogueMedium &a = *findCatalogueMedium(published), &b = *findCatalogueMedium(measured);
    const auto lastDigit = [](double value) { return value >= 10.0 ? 1e-4 : 1e-5; };
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(a.scattering[c], b.scattering[c], lastDigit(a.scattering[c])) << published;
      EXPECT_NEAR(a.absorption[c], b.absorption[c], lastDigit(a.absorption[c])) << published;
      EXPECT_EQ(a.anisotropy[c], b.anisotropy[c]) << published;
    }
  }
}

/// A row of the shared table a line: name, then numbers.
std::map<std::string, std::vector<double>> readTable(const std::filesystem::path& file) {
  std::map<std::string, std::vector<double>> table;
  std::istringstream text(readFileText(file));
  std::string line;
  std::getline(text, line);
  while (std::getline(text, line)) {
    std::istringstream fields(line);
    std::string name, field;
    std::getline(fields, name, ',');
    while (std::getline(fields, field, ',')) table[name].push_back(std::stod(field));
  }
  return table;
}

TEST(MediaCatalogue, MeasuredLiquidsAgreeWithAnIndependentTable) {
  const auto folder = test::sharedAssets("measured-scattering");
  if (folder.empty()) GTEST_SKIP() << "the shared table of measured media is missing";
  const auto table = readTable(folder / "narasimhan2006.csv");
  const std::pair<const char*, const char*> names[] = {{"lowfat milk", "Lowfat Milk"},
                                                       {"reduced milk", "Reduced Milk"},
                                                       {"regular milk", "Regular Milk"},
                                                       {"espresso", "Espresso"},
                                                       {"mint mocha coffee", "Mint Mocha Coffee"},
                                                       {"lowfat soy milk", "Lowfat Soy Milk"},
                                                       {"regular soy milk", "Regular Soy Milk"},
                                                       {"lowfat chocolate milk", "Lowfat Chocolate Milk"},
                                                       {"regular chocolate milk", "Regular Chocolate Milk"},
                                                       {"coke", "Coke"},
                                                       {"pepsi", "Pepsi"},
                                                       {"sprite", "Sprite"},
                                                       {"gatorade", "Gatorade"},
                                                       {"chardonnay", "Chardonnay"},
                                                       {"white zinfandel", "White Zinfandel"},
                                                       {"merlot", "Merlot"},
                                                       {"budweiser", "Budweiser Beer"},
                                                       {"coors light", "Coors Light Beer"},
                                                       {"clorox", "Clorox"},
                                                       {"apple juice", "Apple Juice"},
                                                       {"cranberry juice", "Cranberry Juice"},
                                                       {"grape juice", "Grape Juice"},
                                                       {"ruby grapefruit juice", "Ruby Grapefruit Juice"},
                                                       {"white grapefruit juice", "White Grapefruit Juice"},
                                                       {"shampoo", "Shampoo"},
                                                       {"strawberry shampoo", "Strawberry Shampoo"},
                                                       {"head & shoulders shampoo", "Head & Shoulders Shampoo"}};
  ASSERT_EQ(std::size(names), 27u);
  for (const auto& [ours, theirs] : names) {
    const CatalogueMedium* m = findCatalogueMedium(std::string("measured ") + ours);
    ASSERT_TRUE(m) << ours;
    ASSERT_TRUE(table.contains(theirs)) << theirs;
    const std::vector<double>& row = table.at(theirs);
    // Columns 10.. are reduced scattering and absorption, five digits, from another source than ours.
    expectVector(m->scattering * (1.0 - m->anisotropy), {row[10], row[11], row[12]}, 1e-4,
                 std::string(ours) + " reduced scattering");
    expectVector(m->absorption, {row[13], row[14], row[15]}, 1e-4, std::string(ours) + " absorption");
    expectVector(m->anisotropy, {row[6], row[7], row[8]}, 1e-12, std::string(ours) + " g");
  }
}

TEST(MediaCatalogue, NamesThatResembleAMedium) {
  const std::pair<const char*, const char*> cases[] = {{"Milk.001", "milk"},
                                                       {"glass_of_milk", "milk"},
                                                       {"MilkGlass", "glass"},
                                                       {"CocaCola", "coca cola"},
                                                       {"Cola_Mat", "coca cola"},
                                                       {"GRAPE-JUICE", "grape juice"},
                                                       {"orange juice", "apple juice"},
                                                       {"Rubin", "ruby"},
                                                       {"sklo", "glass"},
                                                       {"M_Espresso", "espresso"}};
  for (const auto& [name, medium] : cases) {
    const CatalogueMedium* found = resemblingMedium(name);
    ASSERT_TRUE(found) << name;
    EXPECT_EQ(found->name, medium) << name;
  }
  for (const char* name : {"wall", "", "Material.001", "metal"}) EXPECT_EQ(resemblingMedium(name), nullptr) << name;
}

// ---------------------------------------------------------------------------------------------------- density grids

std::string bytesOf(std::initializer_list<float> values) {
  std::string text(4 * values.size(), '\0');
  std::memcpy(text.data(), std::data(values), text.size());  // the tests' machines are little endian
  return text;
}

TEST(DensityFile, ReadsEveryFormat) {
  const TempFolder folder;
  const DensityGrid bytes = readDensityGrid(
      folder.write("a.nrrd", std::string("NRRD0004\n# c\ntype: uint8\ndimension: 3\nsizes: 2 1 2\nencoding: raw\n\n") +
                                 std::string("\x00\xff\x33\x66", 4)));
  EXPECT_EQ(bytes.size, glm::ivec3(2, 1, 2));
  EXPECT_EQ(bytes.density, (std::vector<float>{0.0f, 1.0f, 0.2f, 0.4f}));
  const DensityGrid words = readDensityGrid(folder.write(
      "b.nrrd",
      std::string(
          "NRRD0001\r\ntype: ushort\r\ndimension: 3\r\nsizes: 1 1 2\r\nendian: little\r\nencoding: raw\r\n\r\n") +
          std::string("\xff\xff\x00\x80", 4)));
  EXPECT_EQ(words.density, (std::vector<float>{1.0f, 32768.0f / 65535.0f}));
  const DensityGrid raw = readDensityGrid(folder.write("c.raw", bytesOf({0.0f, 2.5f, 1e-3f})), glm::ivec3(3, 1, 1));
  EXPECT_EQ(raw.density, (std::vector<float>{0.0f, 2.5f, 1e-3f}));
  EXPECT_EQ(readDensityGrid(folder.write("d.raw", "\xff\xff\xff"), glm::ivec3(1, 3, 1)).density.size(), 3u);
}

TEST(DensityFile, SharedGridsInBothFormatsAreTheSame) {
  const auto folder = test::sharedAssets("volumes");
  if (folder.empty()) GTEST_SKIP() << "the shared density grids are missing";
  for (const char* name : {"bunny", "fog_noise"}) {
    const DensityGrid a = readDensityGrid(folder / (std::string(name) + ".ktx2"));
    const DensityGrid b = readDensityGrid(folder / (std::string(name) + "_64x64x64_f32.raw"), glm::ivec3(64));
    EXPECT_EQ(a.size, glm::ivec3(64));
    EXPECT_EQ(a.density, b.density);
    double sum = 0.0;
    for (const float d : a.density) sum += d;
    EXPECT_NEAR(sum / static_cast<double>(a.density.size()), std::string(name) == "bunny" ? 0.206 : 0.285,
                0.0006);  // as its README says
  }
}

TEST(DensityFile, WhatIsWrongIsNamedByFile) {
  const TempFolder folder;
  const std::string head = "NRRD0004\ntype: float\ndimension: 3\nsizes: 2 1 1\nendian: little\nencoding: raw\n\n";
  const auto replaced = [&](const std::string& what, const std::string& with) {
    std::string text = head;
    return text.replace(text.find(what), what.size(), with) + bytesOf({1.0f, 1.0f});
  };
  struct Case {
    const char* name;
    std::string content;
    std::optional<glm::ivec3> size;
    const char* part;
  };
  const Case cases[] = {
      {"a.vdb", "x", {}, ".nrrd, .ktx2 or .raw"},
      {"a.nrrd", "", {}, "not a NRRD"},
      {"a.nrrd", "P5\n", {}, "not a NRRD"},
      {"a.nrrd", head.substr(0, head.size() - 1), {}, "no end"},
      {"a.nrrd", head + bytesOf({1.0f}), {}, "truncated"},
      {"a.nrrd", head + bytesOf({1.0f, -1.0f}), {}, "density -1 in cell 1"},
      {"a.nrrd", head + bytesOf({NAN, 1.0f}), {}, "in cell 0"},
      {"a.nrrd", head + bytesOf({INFINITY, 1.0f}), {}, "in cell 0"},
      {"a.nrrd", head + bytesOf({1.0f, 1.0f}), glm::ivec3(1, 2, 1), "the scene says 1x2x1"},
      {"a.nrrd", replaced("2 1 1", "2 1"), {}, "three whole numbers"},
      {"a.nrrd", replaced("2 1 1", "2 1 1 1"), {}, "three whole numbers"},
      {"a.nrrd", replaced("2 1 1", "2 0 1"), {}, "2x0x1"},
      {"a.nrrd", replaced("2 1 1", "2 -1 1"), {}, "2x-1x1"},
      {"a.nrrd", replaced("2 1 1", "4096 4096 4096"), {}, "at most"},
      {"a.nrrd", replaced("dimension: 3", "dimension: 2"), {}, "dimension: 3"},
      {"a.nrrd", replaced("raw", "gzip"), {}, "gzip"},
      {"a.nrrd", replaced("float", "double"), {}, "double"},
      {"a.nrrd", replaced("little", "big"), {}, "little"},
      {"a.nrrd", replaced("encoding: raw", "data file: x.raw"), {}, "x.raw"},
      {"a.ktx2", "KTX", {}, "not a KTX 2"},
      {"a.raw", bytesOf({1.0f}), {}, "\"size\""},
      {"a.raw", bytesOf({1.0f}), glm::ivec3(3, 1, 1), "4 bytes"},
  };
  for (const Case& c : cases) {
    const auto file = folder.write(c.name, c.content);
    const std::string message = badInputMessage([&] { readDensityGrid(file, c.size); });
    EXPECT_TRUE(contains(message, c.name)) << message;
    EXPECT_TRUE(contains(message, c.part)) << c.part << "\n" << message;
  }
  EXPECT_TRUE(contains(badInputMessage([&] { readDensityGrid(folder / "none.raw", glm::ivec3(1)); }), "no such file"));
}

// ---------------------------------------------------------------------------------------------------- the original's
// JSON

const char* kMtl =
    "newmtl wall\nKd 0.2 0.4 0.6\nKs 1 1 1\nKe 5 5 5\nnewmtl milk\nKd 1 1 1\nillum 7\nNi 1.9\nnewmtl unused\nKd 0 0 "
    "0\n";
const char* kObj =
    "mtllib cup.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl wall\nf 1 2 3\nusemtl milk\nf 1 3 2\nf 1 2 4\nf 2 3 "
    "4\nf 1 4 3\n";
const char* kSceneKeys =
    R"("scene": {"camera": [0, 0, 5], "cameraLookAt": [0, 0, 0], "fov": 45, "lightPos": [1, 2, 3],
    "lightColor": [1, 0.5, 0.25], "lightIntensity": 8, "scale": 10.0})";
const char* kMilk =
    R"({"sigma_s": [18.2052, 20.3826, 22.3698], "sigma_a": [0.00153, 0.0046, 0.01993],
    "g": [0.75, 0.714, 0.681], "ior": 1.33})";

struct OriginalFolder : TempFolder {
  OriginalFolder() { write("cup.mtl", kMtl), write("cup.obj", kObj); }
  Scene load(const std::string& text, const std::string& name = "cup.json") const {
    return loadScene(write(name, text));
  }
};

const Material& materialNamed(const Scene& scene, std::string_view name) {
  for (const Material& material : scene.materials)
    if (material.name == name) return material;
  throwBadInput("no material {}", name);
}

TEST(OriginalSceneFile, IsAcceptedAsItIs) {
  const OriginalFolder folder;
  const Scene scene = folder.load(std::string("{") + kSceneKeys + ", \"milk\": " + kMilk + "}");
  EXPECT_EQ(scene.name, "cup");
  EXPECT_EQ(scene.metresPerUnit, 0.01);
  ASSERT_EQ(scene.cameras.size(), 1u);
  EXPECT_EQ(scene.cameras[0].position, glm::dvec3(0, 0, 5));
  EXPECT_EQ(scene.cameras[0].direction, glm::dvec3(0, 0, -1));
  EXPECT_EQ(scene.cameras[0].up, glm::dvec3(0, 1, 0));
  EXPECT_NEAR(scene.cameras[0].verticalFov, 0.25 * 3.14159265358979, 1e-12);
  EXPECT_FALSE(scene.sun);
  EXPECT_FALSE(scene.environment);
  ASSERT_EQ(scene.points.size(), 1u);
  EXPECT_EQ(scene.points[0].position, glm::dvec3(1, 2, 3));
  EXPECT_EQ(scene.points[0].intensity, glm::vec3(8, 4, 2));
  ASSERT_EQ(scene.media.size(), 1u);
  expectVector(glm::dvec3(scene.media[0].scattering), {182.052, 203.826, 223.698}, 1e-6, "1/mm times 10 mm a unit");
  expectVector(glm::dvec3(scene.media[0].absorption), {0.0153, 0.046, 0.1993}, 1e-6, "1/mm times 10 mm a unit");
  EXPECT_EQ(scene.media[0].anisotropy, glm::vec3(0.75f, 0.714f, 0.681f));
  const Material &milk = materialNamed(scene, "milk"), &wall = materialNamed(scene, "wall");
  EXPECT_EQ(milk.bsdf, Bsdf::dielectric);
  EXPECT_EQ(milk.interior, 0);
  EXPECT_EQ(milk.ior, 1.33f);
  EXPECT_EQ(wall.bsdf, Bsdf::diffuse);
  EXPECT_EQ(wall.diffuse, glm::vec3(0.2f, 0.4f, 0.6f));
  EXPECT_EQ(wall.emission, glm::vec3(0.0f));
  EXPECT_EQ(wall.interior, -1);
}

TEST(OriginalSceneFile, IdsMayBeNumbersAndCommentsAreSkipped) {
  const OriginalFolder folder;
  const Scene scene = folder.load(std::string("{") + kSceneKeys + ", \"1\": " + kMilk + ", \"2\": " + kMilk +
                                  R"(, "// wall": {"sigma_s": "later"}, "// note": 3})");
  EXPECT_EQ(materialNamed(scene, "milk").bsdf, Bsdf::dielectric);
  EXPECT_EQ(materialNamed(scene, "wall").bsdf, Bsdf::diffuse);
  EXPECT_EQ(scene.media.size(), 2u);  // the third material is not used by a face, but it is there
}

TEST(OriginalSceneFile, TheOnlyObjInTheFolderWillDo) {
  const OriginalFolder folder;
  EXPECT_EQ(folder.load(std::string("{") + kSceneKeys + "}", "other.json").triangleCount(), 5u);
  folder.write("third.obj", kObj);
  EXPECT_TRUE(contains(badInputMessage([&] { folder.load(std::string("{") + kSceneKeys + "}", "other.json"); }),
                       "no other.obj"));
}

TEST(OriginalSceneFile, WhatIsWrongIsNamedByFileAndKey) {
  const OriginalFolder folder;
  const auto scene = [](const std::string& what, const std::string& with) {
    std::string text = kSceneKeys;
    return "{" + text.replace(text.find(what), what.size(), with) + "}";
  };
  const auto medium = [](const std::string& what, const std::string& with) {
    std::string text = kMilk;
    return std::string("{") + kSceneKeys + ", \"milk\": " + text.replace(text.find(what), what.size(), with) + "}";
  };
  const std::pair<std::string, std::string> cases[] = {
      {R"({"scene": {}})", "no \"camera\""},
      {R"({"scene": 3})", "\"scene\""},
      {scene("[0, 0, 5]", "[0, 0]"), "\"scene.camera\""},
      {scene("[0, 0, 5]", "\"here\""), "\"scene.camera\""},
      {scene("[0, 0, 0]", "[0, 0, 5]"), "\"scene.cameraLookAt\""},
      {scene(": 45", ": 180"), "\"scene.fov\""},
      {scene(": 45", ": 0"), "\"scene.fov\""},
      {scene(R"("fov": 45, )", ""), "no \"fov\""},
      {scene(": 8", ": -8"), "\"scene.lightIntensity\""},
      {scene("[1, 0.5, 0.25]", "[1, -0.5, 0.25]"), "\"scene.lightColor\""},
      {scene("10.0", "0"), "\"scene.scale\""},
      {scene("10.0", "1e999"), "JSON"},
      {scene("\"fov\"", "\"zoom\""), "\"scene.zoom\""},
      {medium("18.2052", "-1"), "\"milk.sigma_s\""},
      {medium("18.2052, ", ""), "\"milk.sigma_s\""},
      {medium("18.2052", "1e38"), "fit into a float"},
      {medium("0.75", "1"), "\"milk.g\""},
      {medium("0.75", "-1.5"), "\"milk.g\""},
      {medium("1.33", "0"), "\"milk.ior\""},
      {medium("1.33", "\"glass\""), "\"milk.ior\""},
      {medium(R"(, "ior": 1.33)", ""), "no \"ior\""},
      {medium("\"g\"", "\"gg\""), "\"milk.gg\""},
      {std::string("{") + kSceneKeys + ", \"tea\": " + kMilk + "}", "wall, milk, unused"},
      {std::string("{") + kSceneKeys + ", \"3\": " + kMilk + "}", "no material of that name or number"},
  };
  for (const auto& [text, expected] : cases) {
    const std::string message = badInputMessage([&, &json = text] { folder.load(json); });
    EXPECT_TRUE(contains(message, "cup.json")) << text << "\n" << message;
    EXPECT_TRUE(contains(message, expected)) << text << "\n" << message;
  }
}

TEST(OriginalSceneFile, ADraftIsAScene) {
  const OriginalFolder folder;
  const auto [text, report] = draftOriginalScene(folder / "cup.mtl");
  EXPECT_EQ(report.size(), 4u);  // the view, and a line a material
  EXPECT_TRUE(contains(text, "\"// wall\""));
  const Scene scene = folder.load(text);
  ASSERT_EQ(scene.media.size(), 1u);
  const Material& milk = materialNamed(scene, "milk");
  EXPECT_EQ(milk.bsdf, Bsdf::dielectric);
  EXPECT_EQ(milk.ior, 1.33f);
  EXPECT_EQ(scene.media[0].scattering, glm::vec3(18.2052f, 20.3826f, 22.3698f));
  EXPECT_EQ(materialNamed(scene, "wall").bsdf, Bsdf::diffuse);
  EXPECT_GT(scene.points[0].intensity.x, 0.0f);
  EXPECT_TRUE(contains(badInputMessage([&] { draftOriginalScene(folder.write("bad.mtl", "newmtl\n")); }), "bad.mtl:1"));
  EXPECT_TRUE(
      contains(badInputMessage([&] { draftOriginalScene(folder.write("bad.mtl", "newmtl a\nNi x\n")); }), "bad.mtl:2"));
  EXPECT_TRUE(
      contains(badInputMessage([&] { draftOriginalScene(folder.write("bad.mtl", "v 0 0 0\n")); }), "no material"));
  EXPECT_TRUE(contains(badInputMessage([&] { draftOriginalScene(folder / "none.mtl"); }), "no such file"));
}

// ---------------------------------------------------------------------------------------------------- media in our
// JSON

struct OurFolder : OriginalFolder {
  Scene load(const std::string& keys, const std::string& scale = R"("scale": 2, )") const {
    return loadScene(
        write("ours.json", "{" + scale + "\"model\": \"cup.obj\"" + (keys.empty() ? "" : ", ") + keys + "}"));
  }
};

TEST(SceneMedia, EveryKeyIsRead) {
  const OurFolder folder;
  folder.write("fog.raw", bytesOf({0.5f, 1.0f}));
  const Scene scene =
      folder.load(R"("media": {"drink": {"catalogue": "milk", "concentration": 0.5, "g": 0.2}, "cola": "coca cola",
        "fog": {"sigma_s": [1, 2, 3], "sigma_a": [0, 0, 1], "phase": "rayleigh", "emission": [0, 1, 2], "ior": 1.1,
                "grid": {"file": "fog.raw", "size": [2, 1, 1], "min": [0, 0, 0], "max": [2, 1, 1], "factor": 4}}},
      "materials": {"milk": {"interior": "drink", "priority": 3, "roughness": 0.25}, "wall": {"bsdf": "none",
      "interior": "fog", "diffuse": [0.1, 0.2, 0.3], "specular": [0, 0, 1], "emission": [3, 2, 1]}},
      "cameraMedium": "fog", "environment": {"radiance": [1, 2, 3], "rotation": 180})");
  ASSERT_EQ(scene.media.size(), 3u);  // in the order of the names
  const Medium &drink = scene.media[1], &fog = scene.media[2];
  EXPECT_EQ(drink.name, "drink");
  expectVector(glm::dvec3(drink.scattering), {18.2052, 20.3826, 22.3698}, 1e-6, "half as much, 2 mm a unit");
  EXPECT_EQ(drink.anisotropy, glm::vec3(0.2f));
  EXPECT_EQ(scene.media[0].name, "cola");
  EXPECT_EQ(fog.scattering, glm::vec3(2, 4, 6));
  EXPECT_EQ(fog.absorption, glm::vec3(0, 0, 2));
  EXPECT_EQ(fog.emission, glm::vec3(0, 2, 4));
  EXPECT_EQ(fog.phase, PhaseFunction::rayleigh);
  ASSERT_TRUE(fog.grid);
  EXPECT_EQ(fog.grid->density, (std::vector<float>{2.0f, 4.0f}));
  EXPECT_EQ(fog.grid->max, glm::dvec3(2, 1, 1));
  const Material &milk = materialNamed(scene, "milk"), &wall = materialNamed(scene, "wall");
  EXPECT_EQ(milk.bsdf, Bsdf::dielectric);
  EXPECT_EQ(milk.interior, 1);
  EXPECT_EQ(milk.ior, 1.33f);
  EXPECT_EQ(milk.priority, 3);
  EXPECT_EQ(milk.roughness, 0.25f);
  EXPECT_EQ(wall.bsdf, Bsdf::none);
  EXPECT_EQ(wall.interior, 2);
  EXPECT_EQ(wall.ior, 1.1f);
  EXPECT_EQ(wall.diffuse, glm::vec3(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(wall.emission, glm::vec3(3, 2, 1));
  EXPECT_EQ(scene.cameraMedium, 2);
  ASSERT_TRUE(scene.environment);
  EXPECT_EQ(scene.environment->radiance, glm::vec3(1, 2, 3));
  EXPECT_NEAR(scene.environment->rotation, 3.14159265358979, 1e-12);
}

TEST(SceneMedia, AnInteriorMayBeOfTheCatalogueAlone) {
  const OurFolder folder;
  const Scene scene =
      folder.load(R"("materials": {"milk": {"interior": "ruby"}, "wall": {"interior": "ruby", "ior": 1.6}})");
  ASSERT_EQ(scene.media.size(), 1u);  // one and the same for both
  EXPECT_EQ(materialNamed(scene, "milk").ior, 1.77f);
  EXPECT_EQ(materialNamed(scene, "wall").ior, 1.6f);
  EXPECT_EQ(materialNamed(folder.load(R"("materials": {"milk": {"interior": null, "ior": 1.4}})"), "milk").interior,
            -1);
}

TEST(SceneMedia, WhatIsWrongIsNamedByFileAndKey) {
  const OurFolder folder;
  folder.write("fog.raw", bytesOf({0.5f, 1.0f}));
  const auto grid = [](const std::string& keys) {
    return R"("media": {"fog": {"sigma_s": [1, 1, 1], "grid": {)" + keys + "}}}";
  };
  const std::pair<std::string, std::string> cases[] = {
      {R"("media": {"a": "tea"})", "\"media.a\""},
      {R"("media": {"a": 3})", "\"media.a\""},
      {R"("media": ["milk"])", "\"media\""},
      {R"("media": {"a": {"sigma": [1, 1, 1]}})", "\"media.a.sigma\""},
      {R"("media": {"a": {"catalogue": "tea"}})", "\"media.a.catalogue\""},
      {R"("media": {"a": {"sigma_s": [1, 1, -1]}})", "\"media.a.sigma_s\""},
      {R"("media": {"a": {"sigma_a": 1}})", "\"media.a.sigma_a\""},
      {R"("media": {"a": {"g": 1}})", "\"media.a.g\""},
      {R"("media": {"a": {"g": [0, 0, -1]}})", "\"media.a.g\""},
      {R"("media": {"a": {"g": 0.99999999999}})", "\"media.a.g\""},
      {R"("media": {"a": {"phase": "mie"}})", "\"media.a.phase\""},
      {R"("media": {"a": {"concentration": 0}})", "\"media.a.concentration\""},
      {R"("media": {"a": {"sigma_s": [3e38, 1, 1]}})", "fit into a float"},
      {grid(R"("file": "fog.raw")"), "\"media.fog.grid\""},
      {grid(R"("file": "gone.raw", "size": [2, 1, 1], "min": [0, 0, 0], "max": [1, 1, 1])"), "gone.raw: no such file"},
      {grid(R"("file": "fog.raw", "size": [2, 1, 1.5], "min": [0, 0, 0], "max": [1, 1, 1])"),
       "\"media.fog.grid.size\""},
      {grid(R"("file": "fog.raw", "size": [2, 1, 1], "min": [0, 0, 0], "max": [1, 0, 1])"), "\"max\""},
      {grid(R"("file": "fog.raw", "size": [2, 1, 1], "min": [0, 0, 0], "max": [1, 1, 1], "factor": 1e308)"),
       "\"media.fog.grid.factor\""},
      {R"("materials": {"tea": {}})", "it has wall, milk"},
      {R"("materials": 3)", "\"materials\""},
      {R"("materials": {"milk": {"bsdf": "glossy"}})", "\"materials.milk.bsdf\""},
      {R"("materials": {"milk": {"ior": 0}})", "\"materials.milk.ior\""},
      {R"("materials": {"milk": {"roughness": 1.5}})", "\"materials.milk.roughness\""},
      {R"("materials": {"milk": {"interior": "tea"}})", "\"materials.milk.interior\""},
      {R"("materials": {"milk": {"bsdf": "mirror", "interior": "milk"}})", "\"materials.milk.interior\""},
      {R"("materials": {"milk": {"priority": 0.5}})", "\"materials.milk.priority\""},
      {R"("materials": {"milk": {"diffuse": [0, 0, 1.5]}})", "\"materials.milk.diffuse\""},
      {R"("cameraMedium": "tea")", "\"cameraMedium\""},
      {R"("environment": {})", "\"environment\""},
      {R"("environment": {"picture": "gone.hdr"})", "gone.hdr"},
      {R"("environment": {"radiance": [1, 1, -1]})", "\"environment.radiance\""},
      {R"("environment": {"radiance": [1, 1, 1], "rotation": "half"})", "\"environment.rotation\""},
  };
  for (const auto& [keys, expected] : cases) {
    const std::string message = badInputMessage([&, &text = keys] { folder.load(text); });
    EXPECT_TRUE(contains(message, expected)) << keys << "\n" << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
  EXPECT_TRUE(contains(badInputMessage([&] { folder.load(R"("media": {"a": "milk"})", ""); }), "\"scale\""));
  EXPECT_TRUE(contains(badInputMessage([&] { folder.load(R"("materials": {"milk": {"interior": "milk"}})", ""); }),
                       "\"scale\""));
}

}  // namespace
}  // namespace lucerna
