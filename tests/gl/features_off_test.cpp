// What a scene does not need: no resource of it in any program, none of its bytes, no pass of its name; and leaving it
// out changes nothing but rounding.
#include "irradiance_cache/irradiance_cache_frame.hpp"
#include "irradiance_cache/settings.hpp"
#include "lpv/lpv_frame.hpp"
#include "lpv/settings.hpp"
#include "measure/neutral.hpp"
#include "render/renderer.hpp"
#include "support/gl_fixture.hpp"
#include "support/small_scenes.hpp"

#include <algorithm>
#include <cmath>

namespace {

using namespace lucerna;

struct Need {
  const char* name;
  std::vector<const char*> resources;  ///< of programs
  std::vector<const char*> stages;  ///< timed passes
};

const Need kFeatures[] = {{"diffuseTextures", {"diffuseTexture"}, {}},
                          {"alphaMasks", {"maskTexture"}, {}},
                          {"specular", {"materialSpecular", "materialAlpha"}, {}},
                          {"emission", {"materialEmission"}, {}},
                          {"background", {}, {}},
                          {"environment", {"environmentRadiance"}, {"environment"}},
                          {"environmentPicture", {"environmentTexture", "environmentTurn"}, {"environment"}},
                          {"spotLights", {"spotShadows"}, {"spot shadows"}},
                          {"pointLights", {"pointShadows"}, {"point shadows"}},
                          {"emissionTextures", {"emissionTexture"}, {}},
                          {"normalMaps", {"normalTexture", "materialNormalScale"}, {}},
                          {"metalMaps", {"metalTexture", "materialMetallic"}, {}}};

class FeaturesOff : public test::GlTest {
 protected:
  struct Drawn {
    std::vector<std::string> resources, stages, leftOut;
    std::size_t gpuBytes = 0, programs = 0;
    Image picture;
  };
  static Drawn draw(const Scene& scene) {
    gl::ProgramLibrary library;
    RenderSettings settings;
    settings.technique = "lpv";
    settings.size = {48, 32};
    settings.fullFloatTarget = true;
    settings.shadow.size = 256;
    settings.of<ReflectiveShadowMap::Settings>().size = 64;
    settings.lights.spotSize = settings.lights.pointSize = 64;
    settings.of<LpvSettings>().cascades.cells = 8;
    settings.of<LpvSettings>().blocking =
        false;  // a lamp however dark adds what it sees to the geometry volume: such data are not neutral there
    Renderer renderer(context(), library, scene, settings);
    renderer.render(test::openBoxCamera());
    renderer.render(test::openBoxCamera());  // the first times of a stage are dropped
    renderer.drain();
    Drawn drawn;
    for (const auto& program : library.programs())
      for (const std::string& resource : program->activeResources()) drawn.resources.push_back(resource);
    for (const gl::StageStatistics& stage : renderer.timer().statistics()) drawn.stages.push_back(stage.name);
    drawn.leftOut = renderer.leftOut();
    drawn.gpuBytes = renderer.gpuBytes();
    drawn.programs = library.programs().size();
    drawn.picture = renderer.readRadiance();
    return drawn;
  }
  static bool contains(const std::vector<std::string>& names, const std::string& name) {
    return std::any_of(names.begin(), names.end(),
                       [&](const std::string& n) { return n == name || n.find(name) != std::string::npos; });
  }
};

TEST_F(FeaturesOff, EveryNeutralFeatureHasARow) {
  ASSERT_EQ(measure::neutralFeatures().size(), std::size(kFeatures));
  for (const Need& need : kFeatures)
    EXPECT_EQ(std::count(measure::neutralFeatures().begin(), measure::neutralFeatures().end(), need.name), 1)
        << need.name;
}

TEST_F(FeaturesOff, LeavesNothingBehindAndChangesNothing) {
  const Scene lean = test::openBox();
  const Drawn off = draw(lean);
  double brightest = 0.0;
  for (const glm::vec3& p : off.picture.pixels)
    brightest = std::max({brightest, static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)});
  for (const Need& need : kFeatures) {
    SCOPED_TRACE(need.name);
    Scene scene = lean;
    measure::addNeutral(scene, need.name);
    const Drawn on = draw(scene);
    EXPECT_TRUE(contains(off.leftOut, need.name));
    EXPECT_FALSE(std::count(on.leftOut.begin(), on.leftOut.end(), need.name));
    for (const char* resource : need.resources) {
      EXPECT_FALSE(contains(off.resources, resource)) << resource;
      EXPECT_TRUE(contains(on.resources, resource)) << resource;
    }
    for (const char* stage : need.stages) {
      EXPECT_FALSE(contains(off.stages, stage)) << stage;
      EXPECT_TRUE(contains(on.stages, stage)) << stage;
    }
    // A uniform has no bytes of its own; what has a texture or a buffer does.
    const bool isConstant = std::string_view(need.name) == "environment";
    const bool isPicture = std::string_view(need.name) == "specular" ||  // its table of reflectances
                           std::string_view(need.name).ends_with("Textures") ||
                           std::string_view(need.name).ends_with("Maps") ||
                           std::string_view(need.name).ends_with("Masks");
    if ((!need.stages.empty() && !isConstant) || isPicture) {
      EXPECT_LT(off.gpuBytes, on.gpuBytes);
    } else {
      EXPECT_EQ(off.gpuBytes, on.gpuBytes);
    }
    double largest = 0.0;
    for (std::size_t i = 0; i < off.picture.pixels.size(); ++i)
      for (int c = 0; c < 3; ++c)
        largest = std::max(largest, std::abs(static_cast<double>(off.picture.pixels[i][c]) -
                                             static_cast<double>(on.picture.pixels[i][c])));
    EXPECT_LE(largest, 1e-5 * brightest);
  }
}

// How light is transported decides what else there is.
TEST_F(FeaturesOff, EachTransportLeavesTheOthersStagesOut) {
  struct Made {
    std::string programs, stages;
    std::vector<std::string> leftOut;
    bool cache, volume;
    std::size_t gpuBytes;
  };
  using Way = std::pair<std::string_view, CacheTransport>;
  const Way propagate{"lpv", CacheTransport::rays}, rays{"irradiance-cache", CacheTransport::rays},
      gather{"irradiance-cache", CacheTransport::gather};
  const auto draw = [](const Way& way, Component component, const Scene& scene, int bounces = 1) {
    gl::ProgramLibrary library;
    RenderSettings settings;
    settings.technique = way.first;
    settings.component = component;
    settings.size = {48, 32};
    settings.shadow.size = 256;
    settings.of<ReflectiveShadowMap::Settings>().size = 64;
    settings.of<LpvSettings>().cascades.cells = settings.of<IrradianceCacheSettings>().cascades.cells = 8;
    settings.of<IrradianceCacheSettings>().transport = way.second;
    settings.of<IrradianceCacheSettings>().bounces = bounces;
    settings.of<IrradianceCacheSettings>().samples = 16;
    Renderer renderer(context(), library, scene, settings);
    renderer.renderToTheEnd(test::openBoxCamera());
    Made drawn;
    for (const std::string& name : library.names()) drawn.programs += name + "\n";
    for (const auto& program : library.programs())
      for (const std::string& resource : program->activeResources())
        drawn.programs += program->name() + ":" + resource + "\n";
    for (const gl::StageStatistics& stage : renderer.timer().statistics()) drawn.stages += stage.name + "\n";
    drawn.leftOut = renderer.leftOut();
    drawn.cache = cacheOf(renderer.technique()) != nullptr;
    drawn.volume = volumeOf(renderer.technique()) != nullptr;
    drawn.gpuBytes = renderer.gpuBytes();
    return drawn;
  };
  const auto has = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  const auto leaves = [](const Made& drawn, const char* name) {
    return std::count(drawn.leftOut.begin(), drawn.leftOut.end(), name) > 0;
  };
  // Programs, stages and resources of one are not those of the other.
  Scene scene = test::openBox();
  const Made propagated = draw(propagate, Component::all, scene), traced = draw(rays, Component::all, scene);
  for (const char* part :
       {"cache list records", "cache paths", "cacheIrradiance", "TriangleBlock", "visibleDepth", "PathBlock"}) {
    EXPECT_FALSE(has(propagated.programs, part)) << part << " in\n" << propagated.programs;
    EXPECT_TRUE(has(traced.programs, part)) << part << " in\n" << traced.programs;
  }
  for (const char* part : {"rsm", "lpv inject", "lpv propagate", "lpv join", "geometry volume", "lpvRed"}) {
    EXPECT_FALSE(has(traced.programs, part)) << part << " in\n" << traced.programs;
    EXPECT_TRUE(has(propagated.programs, part)) << part << " in\n" << propagated.programs;
  }
  for (const char* stage : {"irradiance cache", "geometry\n"}) {
    EXPECT_FALSE(has(propagated.stages, stage)) << stage;
    EXPECT_TRUE(has(traced.stages, stage)) << stage;
  }
  for (const char* stage : {"rsm", "injection", "geometry volume", "propagation"}) {
    EXPECT_FALSE(has(traced.stages, stage)) << stage;
    EXPECT_TRUE(has(propagated.stages, stage)) << stage;
  }
  EXPECT_FALSE(propagated.cache);
  EXPECT_TRUE(propagated.volume);
  EXPECT_TRUE(traced.cache);
  EXPECT_FALSE(traced.volume);
  EXPECT_TRUE(leaves(propagated, "irradiance cache"));
  EXPECT_FALSE(leaves(traced, "irradiance cache"));
  for (const char* name : {"reflective shadow map", "light propagation volume"}) {
    EXPECT_TRUE(leaves(traced, name)) << name;
    EXPECT_FALSE(leaves(propagated, name)) << name;
  }

  // Direct light of a scene without emissive surfaces and sky is shadow maps alone: no records, and as many bytes as
  // direct light has.
  const Made direct = draw(rays, Component::direct, scene);
  EXPECT_FALSE(direct.cache);
  EXPECT_FALSE(has(direct.programs, "cache")) << direct.programs;
  EXPECT_FALSE(has(direct.stages, "irradiance cache"));
  EXPECT_EQ(direct.gpuBytes, draw(propagate, Component::direct, scene).gpuBytes);
  // Gathered, one bounce of the sun needs neither points that keep light nor rays to them; more bounces do.
  const Made once = draw(gather, Component::all, scene), twice = draw(gather, Component::all, scene, 2);
  for (const char* part :
       {"cache gather hemisphere", "cache trace bounces", "cache bounce", "BounceLinks", "bounceSlots"}) {
    EXPECT_FALSE(has(once.programs, part)) << part << " in\n" << once.programs;
    EXPECT_TRUE(has(twice.programs, part)) << part << " in\n" << twice.programs;
  }
  EXPECT_FALSE(has(twice.programs, "cache gather emission")) << twice.programs;
  EXPECT_LT(once.gpuBytes, twice.gpuBytes);

  scene.environment = Environment{};
  scene.environment->radiance = glm::vec3(1.0f);
  EXPECT_TRUE(draw(rays, Component::direct, scene).cache);
  // And of one without any light there is nothing to keep.
  scene.environment.reset();
  scene.sun.reset();
  EXPECT_FALSE(draw(rays, Component::all, scene).cache);
}

// Split cells and smoothed noise are of finished pictures along rays; elsewhere nothing of them is compiled, and no
// bytes are allocated.
TEST_F(FeaturesOff, CellsAreSplitInFinishedPicturesAlone) {
  struct Made {
    std::string programs;
    std::size_t gpuBytes;
  };
  const auto draw = [](bool wholePictures, CacheTransport transport, int split, bool smooths) {
    gl::ProgramLibrary library;
    RenderSettings settings;
    settings.size = {48, 32};
    settings.shadow.size = 256;
    settings.of<ReflectiveShadowMap::Settings>().size = 64;
    settings.wholePictures = wholePictures;
    auto& cache = settings.of<IrradianceCacheSettings>();
    cache.cascades.cells = 8;
    cache.transport = transport;
    cache.samples = 16;
    cache.split = split;
    cache.smooths = smooths;
    const Scene scene = test::openBox();
    Renderer renderer(context(), library, scene, settings);
    renderer.renderToTheEnd(test::openBoxCamera());
    std::string programs;
    for (const auto& program : library.programs())
      for (const std::string& resource : program->activeResources())
        programs += program->name() + ":" + resource + "\n";
    return Made{programs, renderer.gpuBytes()};
  };
  const auto has = [](const Made& made, const char* part) { return made.programs.find(part) != std::string::npos; };
  const Made on = draw(true, CacheTransport::rays, 4, true), motion = draw(false, CacheTransport::rays, 4, true),
             off = draw(true, CacheTransport::rays, 1, false), gathered = draw(true, CacheTransport::gather, 4, true);
  for (const char* part : {"cache mark parts", "cache claim parts", "cache store parts", "cacheParts", "cacheTiles",
                           "shareOfParts", "pathsOfRound"}) {
    EXPECT_TRUE(has(on, part)) << part << " in\n" << on.programs;
    for (const Made* made : {&motion, &off, &gathered}) EXPECT_FALSE(has(*made, part)) << part;
  }
  EXPECT_EQ(motion.gpuBytes, off.gpuBytes);
  EXPECT_LT(off.gpuBytes, on.gpuBytes);
}

}  // namespace
