// GLSL functions for participating media against their double-precision reference implementations, and their samples
// against their densities.
#include "pathtracer/media.hpp"
#include "support/gl_fixture.hpp"
#include "support/media_reference.hpp"

#include "gl/pass.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace lucerna {
namespace {

enum What { numeric, hgSample, phasePdf, rayleigh, fresnel, weights, density, march, counts, integral };

struct MediaProbe {
  glm::vec4 a{0.0f}, b{0.0f};
  glm::uvec4 k{0u};
};
struct Answer {
  glm::vec4 a{0.0f}, b{0.0f};
};

double relative(double value, double exact) { return std::abs(value - exact) / std::max(std::abs(exact), 1e-300); }
glm::dvec3 unitVector(std::mt19937& random) {
  std::normal_distribution<double> n;
  return glm::normalize(glm::dvec3(n(random), n(random), n(random)));
}

class MediaFunctions : public test::SharedProgramsTest {
 protected:
  template <class T>
  static gl::Buffer bufferOf(const std::vector<T>& data, GLuint binding) {
    const T nothing{};
    gl::Buffer buffer("test", std::max<std::size_t>(data.size(), 1) * sizeof(T), data.empty() ? &nothing : data.data(),
                      gl::Usage::staticDraw);
    buffer.bindStorage(binding);
    return buffer;
  }

  std::vector<Answer> probe(What what, const std::vector<MediaProbe>& probes, const std::vector<Medium>& media = {},
                            const PackedBoundaries& boundaries = {}, int outerMedium = -1,
                            const gl::ShaderFlags& deviations = {{"FRESNEL_AMPLITUDES", 0}, {"FRESNEL_SCHLICK", 0}}) {
    const gl::Program& program = library().loadCompute("media probe", "pathtracer/media_probe.comp", deviations);
    const PackedMedia packed = packMedia(media);
    const gl::Buffer in = bufferOf(probes, 3), out = bufferOf(std::vector<Answer>(probes.size()), 4),
                     records = bufferOf(packed.media, 2), grids = bufferOf(packed.grids, 0),
                     densities = bufferOf(packed.densities, 1), interiors = bufferOf(boundaries.interiors, 7);
    {
      const gl::ComputePass pass("probe");
      program.use();
      program.set("what", static_cast<int>(what));
      program.set("outerMedium", outerMedium);
      program.set("dielectricRanks", boundaries.dielectricRanks);
      pass.dispatch({static_cast<int>(probes.size()), 1, 1}, {64, 1, 1});
    }
    return out.read<Answer>();
  }
};

TEST_F(MediaFunctions, LogarithmAndExponentialKeepTheirDigitsInThinMedia) {
  std::vector<MediaProbe> probes;
  for (int i = 0; i < 4096; ++i) {
    MediaProbe p;
    p.k.x = i < 64 ? static_cast<glm::uint>(i) : static_cast<glm::uint>(std::exp2(i * 32.0 / 4096.0) - 0.5);
    p.a.x = static_cast<float>(std::exp2(-30.0 + i * 36.0 / 4096.0));
    p.a.y = static_cast<float>(std::exp2(-30.0 + i * 29.9 / 4096.0));
    probes.push_back(p);
  }
  probes.back().k.x = 0xffffffffu;
  const auto answers = probe(numeric, probes);
  double worst[3]{};
  for (std::size_t i = 0; i < probes.size(); ++i) {
    worst[0] = std::max(worst[0], relative(answers[i].a.x, -std::log1p(-(probes[i].k.x + 0.5) * 0x1p-32)));
    worst[1] = std::max(worst[1], relative(answers[i].a.y, -std::expm1(-static_cast<double>(probes[i].a.x))));
    worst[2] = std::max(worst[2], relative(answers[i].a.z, -std::log1p(-static_cast<double>(probes[i].a.y))));
  }
  std::printf("relative errors: exponentialSample %.1e, 1-exp %.1e, -log(1-u) %.1e\n", worst[0], worst[1], worst[2]);
  // Beyond u = 1/2 what is left is log()'s own: llvmpipe's is 6.9e-7 off in absolute terms, against 0.69 at least.
  for (const double w : worst) EXPECT_LT(w, 2e-6);
}

TEST_F(MediaFunctions, HenyeyGreensteinForEveryG) {
  std::mt19937 random(1);
  std::printf("g           1-cos    pdf      mean cosine - g, in standard errors\n");
  for (const double g : {0.0, 1e-7, -1e-6, 1e-4, 1e-3, -0.3, 0.75, -0.9, 0.99, -0.999, 0.9999, 0.999999, -0.99999}) {
    std::vector<MediaProbe> probes(1 << 16);
    for (MediaProbe& p : probes) {
      p.a = glm::vec4(glm::vec3(unitVector(random)), 0.0f);
      p.b = glm::vec4(static_cast<float>(1.0 - g), static_cast<float>(1.0 + g), 0.0f, 0.0f);
      p.k = glm::uvec4(random(), random(), 0u, 0u);
    }
    const auto answers = probe(hgSample, probes);
    double worstAngle = 0.0, worstPdf = 0.0, sum = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < probes.size(); ++i) {
      const double xi = (probes[i].k.x >> 8) * 0x1p-24;
      const glm::dvec3 w(glm::normalize(glm::dvec3(glm::vec3(probes[i].a)))), to(glm::vec3(answers[i].a));
      const double cosine = reference::henyeyGreensteinCosine(g, xi), back = 1.0 - cosine;
      // A float direction holds its angle to 1e-7 or so: what 1 - cos = angle^2 / 2 can keep of that.
      worstAngle = std::max(worstAngle, std::abs(std::sqrt(2.0 * answers[i].b.x) - std::sqrt(2.0 * back)));
      // The density against the direction that was given, since near |g| = 1 it changes manifold within that angle.
      const double given = g >= 0.0 ? 1.0 - 0.5 * glm::dot(to - w, to - w) : 0.5 * glm::dot(to + w, to + w) - 1.0;
      if (std::abs(g) < 0.995)
        worstPdf = std::max(worstPdf, relative(answers[i].a.w, reference::henyeyGreensteinPdf(g, given)));
      // 1 - cos as the GPU has it: its spread is that of cos, and near g = 1 it keeps the digits that cos has lost.
      sum += answers[i].b.x;
      squares += static_cast<double>(answers[i].b.x) * static_cast<double>(answers[i].b.x);
      ASSERT_NEAR(glm::length(to), 1.0, 1e-6) << g;
      ASSERT_TRUE(std::isfinite(answers[i].a.w)) << g;
    }
    const double n = static_cast<double>(probes.size()), mean = sum / n,
                 deviation = std::sqrt((squares / n - mean * mean) / n);
    std::printf("%-11g %.1e  %.1e  %.2f\n", g, worstAngle, worstPdf, (1.0 - mean - g) / std::max(deviation, 1e-12));
    EXPECT_LT(worstAngle, 8e-7) << g;
    EXPECT_LT(worstPdf, 5e-5) << g;
    // Beyond, the mean hangs on samples so rare that these have none of them.
    if (std::abs(g) < 0.99995) { EXPECT_LT(std::abs(1.0 - mean - g), 4.0 * deviation + 1e-9) << g; }
  }
}

TEST_F(MediaFunctions, PhaseFunctionsIntegrateToOneAndHaveTheirMeanCosine) {
  // By the GPU's own values on a Gauss-like grid in the cosine, substituted so that a peak of |g| = 0.99 is resolved: x
  // = cdf.
  const glm::dvec3 w(0.0, 0.0, 1.0);
  for (const double g : {0.0, 1e-3, 0.5, -0.75, 0.99, -0.99}) {
    const int n = 20000;
    std::vector<MediaProbe> probes;
    for (int i = 0; i < n; ++i) {
      const double c = reference::henyeyGreensteinCosine(g, (i + 0.5) / n), s = std::sqrt((1.0 - c) * (1.0 + c));
      MediaProbe p;
      p.a = glm::vec4(glm::vec3(w), static_cast<float>(1.0 - g));
      p.b = glm::vec4(static_cast<float>(s), 0.0f, static_cast<float>(c), static_cast<float>(1.0 + g));
      probes.push_back(p);
    }
    const auto answers = probe(phasePdf, probes);
    double one = 0.0, mean = 0.0, mirrored = 0.0, rayleighSum = 0.0;
    for (int i = 0; i < n; ++i) {
      const double c = probes[static_cast<std::size_t>(i)].b.z, perXi = 1.0 / reference::henyeyGreensteinPdf(g, c);
      one += answers[static_cast<std::size_t>(i)].a.x * perXi / n;
      mean += answers[static_cast<std::size_t>(i)].a.x * perXi * c / n;
      // The third channel has the opposite g: p(-g, c) = p(g, -c).
      mirrored =
          std::max(mirrored, relative(answers[static_cast<std::size_t>(i)].a.z, reference::henyeyGreensteinPdf(-g, c)));
      rayleighSum += answers[static_cast<std::size_t>(i)].a.w * perXi / n;
    }
    EXPECT_NEAR(one, 1.0, 2e-5) << g;
    EXPECT_NEAR(mean, g, 2e-5) << g;
    EXPECT_LT(mirrored, std::abs(g) < 0.9 ? 1e-5 : 1e-3) << g;
    if (std::abs(g) < 0.6) { EXPECT_NEAR(rayleighSum, 1.0, 1e-4) << g; }
  }
}

/// Pearson's chi-square of samples over 40 cosines x 8 azimuths of equal probability; its p-value by Wilson and
/// Hilferty.
double chiSquareP(const std::vector<glm::dvec2>& cdfAndTurn) {
  constexpr int kRows = 40, kColumns = 8;
  std::vector<double> count(kRows * kColumns);
  for (const glm::dvec2& s : cdfAndTurn) {
    const int row = std::clamp(static_cast<int>(s.x * kRows), 0, kRows - 1),
              column = std::clamp(static_cast<int>(s.y * kColumns), 0, kColumns - 1);
    ++count[static_cast<std::size_t>(row * kColumns + column)];
  }
  const double expected = static_cast<double>(cdfAndTurn.size()) / (kRows * kColumns), freedom = kRows * kColumns - 1;
  double x = 0.0;
  for (const double c : count) x += (c - expected) * (c - expected) / expected;
  const double z = (std::cbrt(x / freedom) - (1.0 - 2.0 / (9.0 * freedom))) / std::sqrt(2.0 / (9.0 * freedom));
  return 0.5 * std::erfc(z / std::sqrt(2.0));
}

TEST_F(MediaFunctions, SamplesFollowTheirDensities) {
  // Significance 0.001 over all (Sidak over the cases).
  std::mt19937 random(7);
  const std::vector<double> gs{0.0, 1e-3, 0.3, -0.6, 0.9, -0.99, 0.999};
  const double threshold = 1.0 - std::pow(1.0 - 0.001, 1.0 / static_cast<double>(gs.size() + 1));
  for (std::size_t which = 0; which <= gs.size(); ++which) {
    const bool isRayleigh = which == gs.size();
    const double g = isRayleigh ? 0.0 : gs[which];
    const glm::dvec3 w = unitVector(random), t = glm::normalize(glm::cross(w, glm::dvec3(0.3, -0.5, 0.8))),
                     b = glm::cross(w, t);
    std::vector<MediaProbe> probes(1 << 17);
    for (MediaProbe& p : probes) {
      p.a = glm::vec4(glm::vec3(w), 0.0f);
      p.b = glm::vec4(static_cast<float>(1.0 - g), static_cast<float>(1.0 + g), 0.0f, 0.0f);
      p.k = glm::uvec4(random(), random(), 0u, 0u);
    }
    const auto answers = probe(isRayleigh ? rayleigh : hgSample, probes);
    std::vector<glm::dvec2> samples;
    for (const Answer& answer : answers) {
      const glm::dvec3 to(glm::vec3(answer.a));
      const double cosine = g >= 0.0 ? 1.0 - 0.5 * glm::dot(to - w, to - w) : 0.5 * glm::dot(to + w, to + w) - 1.0;
      samples.emplace_back(isRayleigh ? reference::rayleighCdf(cosine) : reference::henyeyGreensteinCdf(g, cosine),
                           std::atan2(glm::dot(to, b), glm::dot(to, t)) / (2.0 * M_PI) + 0.5);
    }
    const double p = chiSquareP(samples);
    std::printf("%s %g: p = %.3f\n", isRayleigh ? "Rayleigh" : "g", g, p);
    EXPECT_GT(p, threshold) << g;
  }
}

TEST_F(MediaFunctions, FresnelIsExactAndItsDeviationsAreTheTabledOnes) {
  std::vector<MediaProbe> probes;
  for (const double n : {1.0001, 1.1, 1.33, 1.5, 2.417})
    for (int i = 0; i <= 200; ++i)
      for (const double eta : {n, 1.0 / n}) {
        MediaProbe p;
        p.a = glm::vec4(static_cast<float>(i / 200.0), static_cast<float>(eta), 0.0f, 0.0f);
        probes.push_back(p);
      }
  const auto answers = probe(fresnel, probes);
  for (std::size_t i = 0; i < probes.size(); ++i) {
    const double c = probes[i].a.x, eta = probes[i].a.y;
    ASSERT_NEAR(answers[i].a.x, reference::fresnel(c, eta), 3e-6) << c << " " << eta;
  }
  // The angles inside glass of n = 1.5, and its average over the hemisphere outside.
  const double degrees[] = {0, 20, 30, 40, 41, 41.8, 42, 60, 80},
               exact[] = {.0400, .0417, .0552, .2453, .3798, .8908, 1, 1, 1},
               schlick[] = {.0400, .0400, .0400, .0407, .0409, .0410, 1, 1, 1};
  std::vector<MediaProbe> angles;
  for (const double d : degrees) {
    MediaProbe p;
    p.a = glm::vec4(static_cast<float>(std::cos(d * M_PI / 180.0)), 1.5f, 0.0f, 0.0f);
    angles.push_back(p);
  }
  const auto right = probe(fresnel, angles),
             wrong = probe(fresnel, angles, {}, {}, -1, {{"FRESNEL_AMPLITUDES", 0}, {"FRESNEL_SCHLICK", 1}}),
             amplitudes = probe(fresnel, angles, {}, {}, -1, {{"FRESNEL_AMPLITUDES", 1}, {"FRESNEL_SCHLICK", 0}});
  for (std::size_t i = 0; i < angles.size(); ++i) {
    EXPECT_NEAR(right[i].a.x, exact[i], 6e-5) << degrees[i];
    EXPECT_NEAR(wrong[i].a.x, schlick[i], 6e-5) << degrees[i];
  }
  EXPECT_NEAR(amplitudes[0].a.x, 0.0, 1e-6);  // r_s = 0.2 and r_p = -0.2 cancel at normal incidence
  const int n = 4000;
  std::vector<MediaProbe> hemisphere;
  for (int i = 0; i < n; ++i) {
    MediaProbe p;
    p.a = glm::vec4(static_cast<float>(std::sqrt((i + 0.5) / n)), static_cast<float>(1.0 / 1.5), 0.0f, 0.0f);
    hemisphere.push_back(p);
  }
  double diffuse = 0.0;
  for (const Answer& a : probe(fresnel, hemisphere)) diffuse += a.a.x / n;
  EXPECT_NEAR(diffuse, 0.0917779593, 2e-5);
}

Medium mediumOf(const glm::vec3& scattering, const glm::vec3& absorption) {
  Medium medium;
  medium.scattering = scattering;
  medium.absorption = absorption;
  return medium;
}

TEST_F(MediaFunctions, SpectralWeightsAreTheReferencesAndConserveTheSumOfChannels) {
  const std::vector<Medium> media{
      mediumOf({1.0f, 5.0f, 1000.0f}, glm::vec3(0.0f)), mediumOf({0.0f, 2.0f, 0.3f}, {0.0f, 0.1f, 7.0f}),
      mediumOf(glm::vec3(3.0f), {0.0f, 1.0f, 2.0f}), mediumOf({1e-6f, 1e-3f, 1e4f}, glm::vec3(0.0f))};
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<MediaProbe> probes;
  for (int i = 0; i < 4096; ++i) {
    MediaProbe p;
    p.k = glm::uvec4(static_cast<glm::uint>(i & 3), random(), random(), 0u);
    for (int c = 0; c < 3; ++c) p.a[c] = static_cast<float>(std::exp2(-20.0 * unit(random)));
    if (i % 7 == 0) p.a[i / 7 % 3] = 0.0f;
    p.a.w = static_cast<float>(std::exp2(-16.0 + 24.0 * unit(random)));  // optical depths to 2.5e6
    probes.push_back(p);
  }
  const auto answers = probe(weights, probes, media);
  for (std::size_t i = 0; i < probes.size(); ++i) {
    const Medium& medium = media[probes[i].k.x];
    const glm::dvec3 beta(glm::vec3(probes[i].a)), q = beta / (beta.x + beta.y + beta.z);
    const glm::dvec3 scatter = reference::scatteringWeight(medium, q, probes[i].a.w),
                     pass = reference::passageWeight(medium, q, probes[i].a.w);
    glm::dvec3 after(0.0), passed(0.0);
    for (int c = 0; c < 3; ++c) {
      ASSERT_TRUE(std::isfinite(answers[i].a[c]) && std::isfinite(answers[i].b[c])) << i;
      after[c] = beta[c] * static_cast<double>(answers[i].a[c]);
      passed[c] = beta[c] * static_cast<double>(answers[i].b[c]);
      if (q[c] == 0.0) continue;
      // exp of an argument in the thousands keeps some digits fewer; what has underflowed in the reference
      // implementation has no say.
      if (std::isfinite(scatter[c]) && q[c] * scatter[c] > 1e-12) {
        ASSERT_LT(relative(answers[i].a[c], scatter[c]), 3e-4) << i << " channel " << c;
      }
      if (std::isfinite(pass[c]) && q[c] * pass[c] > 1e-12) {
        ASSERT_LT(relative(answers[i].b[c], pass[c]), 3e-4) << i << " channel " << c;
      }
    }
    const double sum = beta.x + beta.y + beta.z;
    const double passes = (passed.x + passed.y + passed.z) / sum;
    ASSERT_LT(passes, 1.0 + 2e-6) << i;
    if (probes[i].k.x != 1) { ASSERT_GT(passes, 1.0 - 2e-6) << i; }  // the second's blue absorbs most, by weight
    if (probes[i].k.x == 0 || probes[i].k.x == 3) { ASSERT_NEAR((after.x + after.y + after.z) / sum, 1.0, 2e-6) << i; }
    // The channel that was picked has throughput, and a flight of it ends.
    ASSERT_GT(q[static_cast<int>(answers[i].a.w)], 0.0) << i;
    ASSERT_GT(answers[i].b.w, 0.0) << i;
  }
}

DensityGrid unevenGrid() {
  DensityGrid grid;
  grid.size = {19, 8, 13};
  grid.min = {-1.0, 2.0, 0.5};
  grid.max = {2.0, 3.0, 4.5};
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  for (int i = 0; i < 19 * 8 * 13; ++i)
    grid.density.push_back(i % 5 == 0 ? 0.0f : unit(random) * (i % 11 == 0 ? 20.0f : 1.0f));
  return grid;
}

TEST_F(MediaFunctions, DensityIsInterpolatedAndBoundedBlockByBlock) {
  Medium medium = mediumOf(glm::vec3(1.0f), glm::vec3(0.0f));
  medium.grid = unevenGrid();
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(-0.1, 1.1);
  std::vector<MediaProbe> points, rays;
  for (int i = 0; i < 2000; ++i) {
    MediaProbe p;
    const glm::dvec3 extent = medium.grid->max - medium.grid->min;
    p.a = glm::vec4(glm::vec3(medium.grid->min + extent * glm::dvec3(unit(random), unit(random), unit(random))), 3.0f);
    points.push_back(p);
    glm::dvec3 d = unitVector(random);
    if (i % 10 == 0) d = glm::dvec3(i % 3 == 0, i % 3 == 1, i % 3 == 2) * (i % 20 == 0 ? 1.0 : -1.0);
    p.b = glm::vec4(glm::vec3(d), 0.0f);
    rays.push_back(p);
  }
  const auto values = probe(density, points, {medium}), marches = probe(march, rays, {medium});
  int crossed = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const glm::dvec3 o(glm::vec3(points[i].a)), d(glm::vec3(rays[i].b));
    ASSERT_NEAR(values[i].a.x, reference::density(*medium.grid, o), 2e-4) << i;
    // The length inside the box, by the slabs' method in double.
    double near = 0.0, far = 3.0;
    for (int k = 0; k < 3; ++k) {
      if (d[k] == 0.0) {
        if (o[k] < medium.grid->min[k] || o[k] > medium.grid->max[k]) far = -1.0;
        continue;
      }
      const double a = (medium.grid->min[k] - o[k]) / d[k], b = (medium.grid->max[k] - o[k]) / d[k];
      near = std::max(near, std::min(a, b));
      far = std::min(far, std::max(a, b));
    }
    ASSERT_NEAR(marches[i].a.x, std::max(far - near, 0.0), 1e-5) << i;
    ASSERT_GT(marches[i].a.y, -1e-4) << i << ": a block's bound lies below the density in it";
    const double depth = reference::densityIntegral(*medium.grid, o, d, 3.0, 3000);
    ASSERT_NEAR(marches[i].a.w, depth, 0.01 + 0.01 * depth) << i;
    crossed += marches[i].a.z > 1.0f;
  }
  EXPECT_GT(crossed, 300);
}

TEST_F(MediaFunctions, TheDensitysIntegralIsExactAndEndsByItself) {
  Medium medium = mediumOf(glm::vec3(1.0f), glm::vec3(0.0f));
  medium.grid = unevenGrid();
  const glm::dvec3 extent = medium.grid->max - medium.grid->min;
  std::mt19937 random(10);
  std::uniform_real_distribution<double> unit(-0.1, 1.1);
  std::vector<MediaProbe> rays;
  for (int i = 0; i < 1000; ++i) {
    MediaProbe p;
    p.a = glm::vec4(glm::vec3(medium.grid->min + extent * glm::dvec3(unit(random), unit(random), unit(random))), 3.0f);
    glm::dvec3 d = unitVector(random);
    if (i % 10 == 0)
      d = glm::dvec3(i % 3 == 0, i % 3 == 1, i % 3 == 2) *
          (i % 20 == 0 ? 1.0 : -1.0);  // along an axis, and along planes between cells
    p.b = glm::vec4(glm::vec3(d), 0.0f);
    rays.push_back(p);
  }
  const auto answers = probe(integral, rays, {medium});
  double worst = 0.0, most = 0.0, deepest = 0.0;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const glm::dvec3 o(glm::vec3(rays[i].a)), d(glm::vec3(rays[i].b));
    double near = 0.0, far = 3.0;  // in the box
    for (int k = 0; k < 3; ++k) {
      if (d[k] == 0.0) {
        if (o[k] < medium.grid->min[k] || o[k] > medium.grid->max[k]) far = -1.0;
        continue;
      }
      const double a = (medium.grid->min[k] - o[k]) / d[k], b = (medium.grid->max[k] - o[k]) / d[k];
      near = std::max(near, std::min(a, b));
      far = std::min(far, std::max(a, b));
    }
    const double exact = far > near ? reference::densityIntegral(*medium.grid, o + near * d, d, far - near, 4000) : 0.0;
    worst = std::max(worst, std::abs(answers[i].a.x - exact));
    most = std::max(most, static_cast<double>(answers[i].a.y));
    deepest = std::max(deepest, exact);
  }
  std::printf("[ measured ] optical depths to %.3g off by %.1e at most; %.0f iterations at most\n", deepest, worst,
              most);
  EXPECT_GT(deepest, 5.0);
  EXPECT_LT(worst, 1e-4);
  EXPECT_LE(most, 19 + 8 + 13 + 3);
  EXPECT_GT(most, 10);
}

TEST_F(MediaFunctions, BoundariesNestOverlapAndTouchByPriority) {
  Scene scene;
  scene.media.resize(3);
  const auto add = [&](Bsdf bsdf, int priority, float ior, int interior) {
    Material m;
    m.bsdf = bsdf;
    m.priority = priority;
    m.ior = ior;
    m.interior = interior;
    scene.materials.push_back(m);
  };
  add(Bsdf::diffuse, 0, 1.0f, -1);
  add(Bsdf::dielectric, 2, 1.5f, -1);  // glass
  add(Bsdf::dielectric, 1, 1.33f, 0);  // milk
  add(Bsdf::none, 3, 1.0f, 1);  // smoke
  add(Bsdf::dielectric, 2, 1.5f, -1);  // more of the same glass
  const PackedBoundaries packed = rankBoundaries(scene);
  ASSERT_EQ(packed.interiors.size(), 3u);
  EXPECT_EQ(packed.rankOfMaterial[0], -1);
  const int milk = packed.rankOfMaterial[2], glass = packed.rankOfMaterial[1], smoke = packed.rankOfMaterial[3];
  EXPECT_EQ(packed.rankOfMaterial[4], glass);
  EXPECT_LT(milk, glass);
  EXPECT_LT(glass, smoke);

  const auto state = [&](const std::vector<int>& in, const std::vector<int>& out) {
    MediaProbe p;
    for (std::size_t i = 0; i < in.size(); ++i) p.k.x |= static_cast<glm::uint>(in[i]) << (8 * i);
    for (std::size_t i = 0; i < out.size(); ++i) p.k.z |= static_cast<glm::uint>(out[i]) << (8 * i);
    p.k.y = static_cast<glm::uint>(in.size());
    p.k.w = static_cast<glm::uint>(out.size());
    return probe(counts, {p}, {}, packed, 2)[0].a;
  };
  const auto expect = [&](const std::vector<int>& in, const std::vector<int>& out, int medium, float ior, bool sound) {
    const glm::vec4 s = state(in, out);
    EXPECT_EQ(s.y, static_cast<float>(medium));
    EXPECT_FLOAT_EQ(s.z, ior);
    EXPECT_EQ(s.w != 0.0f, sound);
  };
  expect({}, {}, 2, 1.0f, true);  // the outer medium
  expect({milk}, {}, 0, 1.33f, true);
  expect({milk, glass}, {}, -1, 1.5f, true);  // the overlap is glass, in either order
  expect({glass, milk}, {}, -1, 1.5f, true);
  expect({milk, glass}, {glass}, 0, 1.33f, true);
  expect({glass, milk}, {glass}, 0, 1.33f, true);
  expect({glass, smoke}, {}, 1, 1.5f, true);  // smoke in glass keeps the glass' index
  expect({glass, glass}, {glass}, -1, 1.5f, true);  // the same glass twice is left twice
  expect({glass, glass}, {glass, glass}, 2, 1.0f, true);
  expect({milk}, {glass}, 0, 1.33f, false);  // left without having been entered
}

}  // namespace
}  // namespace lucerna
