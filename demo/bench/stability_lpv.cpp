// Stiff and extreme cases of the light propagation volume alone, fed by synthetic reflective shadow maps: its kernel
// has exact answers. The published answers are those of [Kaplanyan2010] with exact solid angles, computed in double
// precision (tests/support/lpv_reference.*).
#include "bench/stability.hpp"
#include "lpv/light_propagation_volume.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lucerna::demo::bench {

namespace {

/// Virtual point lights: position, unit normal, flux of all three channels.
struct Vpl {
  glm::vec3 position;
  glm::vec3 normal{0.0f, 0.0f, 1.0f};
  float flux = 1.0f;
};

struct Setup {
  int cells = 32, iterations = 1;
  bool full = true, blocking = false;
  LpvFill fill = LpvFill::layered;
  float referenceIrradiance = 1.0f;
  float amplifier = 0.0f;  ///< above 0: selects the 4 pi kernel
};

/// One cascade with its corner at the origin, cells of size 1.
class Volume {
 public:
  Volume(const StabilityContext& context, const Setup& setup, const std::vector<Vpl>& vpls)
      : map_(vpls), lpv_(context.programs, context.context.capabilities(), settingsOf(setup)) {
    Cascade cascade;
    cascade.centre = glm::dvec3(0.5 * setup.cells);
    const LpvInputs inputs{{map_.outputs()}, {cascade}, setup.referenceIrradiance};
    lpv_.place(inputs);
    lpv_.inject(inputs);
    lpv_.fillGeometryVolume(inputs);
    lpv_.propagate();
    scale_ = setup.referenceIrradiance;
  }

  /// The flux of the sum of all wavefronts: band 0 times sqrt(4 pi).
  double flux() const {
    double sum = 0.0;
    for (const glm::vec4& c : lpv_.result()[0].readRgba()) sum += static_cast<double>(c.x);
    return sum * scale_ * std::sqrt(4.0 * M_PI);
  }
  std::size_t notFinite() const {
    std::size_t count = 0;
    for (const gl::Texture& channel : lpv_.result())
      for (const glm::vec4& c : channel.readRgba())
        count += !(std::isfinite(c.x) && std::isfinite(c.y) && std::isfinite(c.z) && std::isfinite(c.w));
    return count;
  }

 private:
  class Map {
   public:
    explicit Map(const std::vector<Vpl>& vpls) {
      constexpr int kWidth = 64;
      const int height = std::max(1, (static_cast<int>(vpls.size()) + kWidth - 1) / kWidth);
      std::vector<glm::vec4> position(static_cast<std::size_t>(kWidth) * static_cast<std::size_t>(height)),
          normal = position, flux = position;
      for (std::size_t i = 0; i < vpls.size(); ++i) {
        position[i] = glm::vec4(vpls[i].position, 1.0f);
        normal[i] = glm::vec4(vpls[i].normal, 1.0f);
        flux[i] = glm::vec4(glm::vec3(vpls[i].flux), 1e-6f);
        if (std::isfinite(vpls[i].flux)) largestFlux_ += std::max(0.0f, vpls[i].flux);
      }
      const auto make = [&](const char* name, const std::vector<glm::vec4>& texels) {
        gl::Texture texture(name, gl::Format::rgba32f, glm::ivec3(kWidth, height, 1), {}, 1, gl::TextureKind::array);
        texture.upload(gl::Texels::rgbaFloat, texels.data());
        return texture;
      };
      position_ = make("stability position", position);
      normal_ = make("stability normal", normal);
      flux_ = make("stability flux", flux);
    }
    ReflectiveShadowMap::Outputs outputs() const { return {position_, normal_, flux_, 1.0f, largestFlux_}; }

   private:
    gl::Texture position_, normal_, flux_;
    double largestFlux_ = 0.0;
  };

  static LpvSettings settingsOf(const Setup& setup) {
    LpvSettings s;
    s.cascades.cells = setup.cells;
    s.cascades.cascades = 1;
    s.iterations = setup.iterations;
    s.blocking = setup.blocking;
    s.fill = setup.fill;
    if (setup.full) s.storage = LpvSettings::Storage::full;
    if (setup.amplifier > 0.0f) {
      s.deviations.fourPiKernel = true;
      s.amplifier = setup.amplifier;
    }
    return s;
  }

  Map map_;
  LightPropagationVolume lpv_;
  double scale_ = 1.0;
};

/// In the middle of cell n/2, facing along z. A light is moved half a cell along its normal before its cell is found.
Vpl inTheMiddle(int cells) {
  return {glm::vec3(static_cast<float>(cells / 2) + 0.5f, static_cast<float>(cells / 2) + 0.5f,
                    static_cast<float>(cells / 2) + 0.25f)};
}

double fluxOf(const StabilityContext& context, Setup setup, int iterations, const std::vector<Vpl>& vpls) {
  setup.iterations = iterations;
  return Volume(context, setup, vpls).flux();
}

/// The flux of wavefront number n alone.
double wavefrontFlux(const StabilityContext& context, const Setup& setup, int n) {
  const std::vector<Vpl> light{inTheMiddle(setup.cells)};
  return fluxOf(context, setup, n, light) - fluxOf(context, setup, n - 1, light);
}

void addLpvRow(std::vector<StabilityCase>& cases, std::string name, std::string parameter,
               std::function<Measurement(const StabilityContext&)> run) {
  cases.push_back({"lpv", std::move(name), std::move(parameter), std::move(run)});
}

void addKernel(std::vector<StabilityCase>& cases) {
  // Decay through a border of 32 cells; a wavefront's flux is a difference of sums in 32-bit floats.
  constexpr std::pair<int, double> kDecay[] = {
      {1, 1.138208}, {16, 1.138208}, {32, 1.138115}, {64, 1.123262}, {128, 0.944911}};
  for (const auto& [step, expected] : kDecay)  // clang 14 does not capture structured bindings
    addLpvRow(cases, "one light in 32^3, flux after N steps", fmt::format("N = {}", step),
              [n = step, flux = expected](const StabilityContext& c) {
                return Measurement{flux, wavefrontFlux(c, {}, n), 3e-5};
              });
  struct Tiny {
    int cells, step;
    double flux;
  };
  constexpr Tiny kTiny[] = {{1, 1, 0.0},      {2, 1, .333333}, {2, 2, .110472}, {2, 3, .042324},
                            {3, 1, 1.138208}, {3, 3, .566864}, {3, 6, .147829}};
  for (const Tiny& t : kTiny)
    addLpvRow(cases, "one light in a tiny grid, flux after N steps", fmt::format("{}^3, N = {}", t.cells, t.step),
              [t](const StabilityContext& c) {
                Setup setup;
                setup.cells = t.cells;
                return Measurement{t.flux, wavefrontFlux(c, setup, t.step), 5e-6};
              });
  for (const auto& [amplifier, gain] :
       {std::pair{3.0f, 0.75}, std::pair{4.0f, 1.0}, std::pair{4.2f, 1.05}, std::pair{5.0f, 1.25}})
    addLpvRow(cases, "4 pi kernel, gain of a step (amplifier / 4)", fmt::format("amplifier {:g}", amplifier),
              [amplifier = amplifier, gain = gain](const StabilityContext& c) {
                Setup setup;
                setup.amplifier = amplifier;
                return Measurement{gain, wavefrontFlux(c, setup, 5) / wavefrontFlux(c, setup, 4), 1e-4};
              });
}

void addIterations(std::vector<StabilityCase>& cases) {
  addLpvRow(cases, "no step: the injected light alone", "N = 0", [](const StabilityContext& c) {
    return Measurement{1.0, fluxOf(c, {}, 0, {inTheMiddle(32)}), 1e-6};
  });
  // The sum over all wavefronts of 8^3 is bounded by its value at 256 steps, up to float rounding: the light leaves in
  // ever smaller parts.
  for (const bool full : {true, false})
    addLpvRow(
        cases, fmt::format("ten thousand steps in 8^3 over 256, {} bits", full ? 32 : 16), "N = 10000",
        [full](const StabilityContext& c) {
          Setup setup;
          setup.cells = 8;
          setup.full = full;
          const std::vector<Vpl> light{inTheMiddle(8)};
          return Measurement{1.0, fluxOf(c, setup, 10000, light) / fluxOf(c, setup, 256, light), full ? 1e-5 : 2e-3};
        });
}

void addInjection(std::vector<StabilityCase>& cases) {
  for (const float flux : {1e-12f, 1e-5f, 1e5f, 1e12f})
    addLpvRow(cases, "flux of a light over what it sends, 16 bits", fmt::format("{:g} W", static_cast<double>(flux)),
              [flux](const StabilityContext& c) {
                Setup setup;
                setup.full = false;
                setup.referenceIrradiance = flux;
                Vpl light = inTheMiddle(32);
                light.flux = flux;
                return Measurement{1.0, fluxOf(c, setup, 0, {light}) / static_cast<double>(flux), 1e-3};
              });
  for (const LpvFill fill : {LpvFill::layered, LpvFill::fixed})
    addLpvRow(cases, "ten thousand equal lights in one cell, sum", fmt::format("{}", nameOf(fill)),
              [fill](const StabilityContext& c) {
                Setup setup;
                setup.fill = fill;
                setup.referenceIrradiance = 1e4f;
                return Measurement{1e4, fluxOf(c, setup, 0, std::vector<Vpl>(10000, inTheMiddle(32))), 10.0};
              });
  struct Place {
    const char* name;
    glm::vec3 position;
    double flux;
  };
  static constexpr float kMiddle = 16.5f;
  static const Place kPlaces[] = {{"in cell 0", {0.5f, 0.5f, 0.25f}, 1.0},
                                  {"on a border between cells", {16.0f, 16.0f, 16.0f}, 1.0},
                                  {"in the last cell", {31.5f, 31.5f, 31.25f}, 1.0},
                                  {"below the grid by 0.01", {-0.01f, kMiddle, kMiddle}, 0.0},
                                  {"at the far border", {kMiddle, 32.0f, kMiddle}, 0.0},
                                  {"at -1e30", {-1e30f, kMiddle, kMiddle}, 0.0}};
  for (const Place& place : kPlaces)
    addLpvRow(cases, "flux of a light, by place", place.name, [place](const StabilityContext& c) {
      return Measurement{place.flux, fluxOf(c, {}, 0, {{place.position}}), 1e-6};
    });
}

void addBadTexels(std::vector<StabilityCase>& cases) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInfinity = std::numeric_limits<float>::infinity();
  static const std::pair<const char*, Vpl> kBad[] = {{"NaN position", {glm::vec3(kNan)}},
                                                     {"infinite position", {glm::vec3(kInfinity)}},
                                                     {"NaN normal", {glm::vec3(16.5f), glm::vec3(kNan)}},
                                                     {"zero normal", {glm::vec3(16.5f), glm::vec3(0.0f)}},
                                                     {"NaN flux", {glm::vec3(16.5f), {0, 0, 1}, kNan}},
                                                     {"infinite flux", {glm::vec3(16.5f), {0, 0, 1}, kInfinity}}};
  for (const auto& [name, bad] : kBad)
    addLpvRow(cases, "beside a bad texel: not finite cells after 8 steps", name,
              [bad = bad](const StabilityContext& c) {
                Setup setup;
                setup.iterations = 8;
                const Volume volume(c, setup, {bad, inTheMiddle(32)});
                return Measurement{0.0, static_cast<double>(volume.notFinite()), 0.0};
              });
}

}  // namespace

void addLpvCases(std::vector<StabilityCase>& cases) {
  addKernel(cases);
  addIterations(cases);
  addInjection(cases);
  addBadTexels(cases);
}

}  // namespace lucerna::demo::bench
