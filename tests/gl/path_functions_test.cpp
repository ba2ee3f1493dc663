// The path tracer's GLSL functions against reference implementations in double precision, and the distributions of what
// they draw. Statistical tests: seeds are fixed; chi-square at significance 1e-4.
#include "support/gl_fixture.hpp"

#include "base/angles.hpp"
#include "gl/pass.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

namespace lucerna::test {
namespace {

// ------------------------------------------------------------------------------------------------------------- the
// reference implementations

std::array<std::uint32_t, 4> pcg4d(std::array<std::uint32_t, 4> v) {  // [JarzynskiOlano2020]
  for (auto& x : v) x = x * 1664525u + 1013904223u;
  const auto mix = [&] { v[0] += v[1] * v[3], v[1] += v[2] * v[0], v[2] += v[0] * v[1], v[3] += v[1] * v[2]; };
  mix();
  for (auto& x : v) x ^= x >> 16;
  mix();
  return v;
}

std::uint32_t reversed(std::uint32_t x) {
  std::uint32_t r = 0;
  for (int k = 0; k < 32; ++k) r |= (x >> k & 1u) << (31 - k);
  return r;
}

/// Sobol's first two dimensions by their direction numbers: 1/2, 1/4, ... and v_j = v_(j-1) xor v_(j-1) / 2.
std::uint32_t sobol(std::uint32_t i, int dimension) {
  std::uint32_t v = 0x80000000u, x = 0;
  for (int k = 0; k < 32; ++k) {
    if (i >> k & 1u) x ^= v;
    v = dimension == 0 ? v >> 1 : v ^ (v >> 1);
  }
  return x;
}

/// Its third to fifth dimension: degree, inner coefficients and first direction numbers of [JoeKuo2008].
std::uint32_t furtherSobol(std::uint32_t i, int dimension) {
  struct Row {
    int degree;
    unsigned inner;
    std::array<std::uint32_t, 3> first;
  };
  constexpr std::array<Row, 3> kRows{{{2, 1, {1, 3, 0}}, {3, 1, {1, 3, 1}}, {3, 2, {1, 1, 1}}}};
  const auto& [s, inner, first] = kRows[static_cast<std::size_t>(dimension)];
  std::vector<std::uint64_t> m(first.begin(), first.begin() + s);
  std::uint32_t x = 0;
  for (int k = 0; k < 32; ++k) {
    if (k >= s) {
      const auto before = [&](int j) { return m[static_cast<std::size_t>(k - j)] << j; };
      std::uint64_t next = m[static_cast<std::size_t>(k - s)] ^ before(s);
      for (int j = 1; j < s; ++j)
        if (inner >> (s - 1 - j) & 1u) next ^= before(j);
      m.push_back(next);
    }
    if (i >> k & 1u) x ^= static_cast<std::uint32_t>(m[static_cast<std::size_t>(k)] << (31 - k));
  }
  return x;
}

std::uint32_t scrambled(std::uint32_t x, std::uint32_t seed) {
  x = reversed(x);
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return reversed(x);
}

struct Ggx {
  double alpha;
  double density(const glm::dvec3& h) const {
    const double t = (h.x * h.x + h.y * h.y) / (alpha * alpha) + h.z * h.z;
    return 1.0 / (kPi * alpha * alpha * t * t);
  }
  double lambda(const glm::dvec3& w) const {
    const double tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
    return 0.5 * (std::sqrt(1.0 + alpha * alpha * tan2) - 1.0);
  }
  double g1(const glm::dvec3& w) const { return 1.0 / (1.0 + lambda(w)); }
  double g2(const glm::dvec3& o, const glm::dvec3& i) const { return 1.0 / (1.0 + lambda(o) + lambda(i)); }
  /// Density of visible normals [Heitz2018].
  double visible(const glm::dvec3& o, const glm::dvec3& h) const {
    return g1(o) * std::max(0.0, glm::dot(o, h)) * density(h) / o.z;
  }
  double reflectPdf(const glm::dvec3& o, const glm::dvec3& i) const {
    if (i.z <= 0.0) return 0.0;
    const glm::dvec3 h = glm::normalize(o + i);
    return visible(o, h) / (4.0 * glm::dot(o, h));
  }
  double reflect(const glm::dvec3& o, const glm::dvec3& i) const {  // BSDF times cosine
    const glm::dvec3 h = glm::normalize(o + i);
    return density(h) * g2(o, i) / (4.0 * o.z * i.z) * i.z;
  }
  /// [Walter2007 eq 21, 17] for i below; radiance over n^2; eta: index of o's side over the other's.
  double refract(const glm::dvec3& o, const glm::dvec3& i, double eta, double& pdf) const {
    const double no = eta, ni = 1.0;
    const glm::dvec3 bsdf = -glm::normalize(ni * i + no * o), h = bsdf.z < 0.0 ? -bsdf : bsdf;
    const double oh = glm::dot(o, h), ih = glm::dot(i, h);
    pdf = 0.0;
    if (oh <= 0.0 || ih >= 0.0) return 0.0;
    const double sum = ni * ih + no * oh;
    pdf = visible(o, h) * ni * ni * std::abs(ih) / (sum * sum);
    const double btdf = std::abs(ih * oh) / std::abs(i.z * o.z) * no * no * g2(o, i) * density(h) / (sum * sum);
    return btdf * std::abs(i.z) * (ni * ni) / (no * no);
  }
};

double fresnel(double cosI, double eta) {  // amplitudes of both polarisations, from Snell's law
  const double sin2 = eta * eta * (1.0 - cosI * cosI);
  if (sin2 >= 1.0) return 1.0;
  const double cosT = std::sqrt(1.0 - sin2);
  const double s = (eta * cosI - cosT) / (eta * cosI + cosT), p = (cosI - eta * cosT) / (cosI + eta * cosT);
  return 0.5 * (s * s + p * p);
}

// ------------------------------------------------------------------------------------------------------------- the
// tests

class PathFunctionsTest : public SharedProgramsTest {
 protected:
  using Pair = std::array<glm::vec4, 2>;
  std::vector<Pair> probe(int which, const std::vector<Pair>& inputs, const glm::vec3& corner = {}) {
    const gl::Program& program = library().loadCompute(
        "path probe", "pathtracer/path_probe.comp",
        {{"PROBE", which}, {"GLOSSY", 1}, {"FRESNEL_AMPLITUDES", 0}, {"FRESNEL_SCHLICK", 0}, {"LINEAR_SEEDS", 0}});
    const gl::Buffer in("inputs", inputs.size() * sizeof(Pair), inputs.data(), gl::Usage::staticDraw);
    const gl::Buffer out("outputs", inputs.size() * sizeof(Pair), nullptr, gl::Usage::dynamicRead);
    in.bindStorage(0);
    out.bindStorage(1);
    {
      const gl::ComputePass pass("probe");
      program.use();
      if (which == 3) program.set("corner", corner);
      pass.dispatch({static_cast<int>(inputs.size()), 1, 1}, {64, 1, 1});
    }
    return out.read<Pair>();
  }
  glm::dvec3 upper(double least = 0.05) {
    const double z = least + (1.0 - least) * uniform_(engine_), a = 2.0 * kPi * uniform_(engine_),
                 r = std::sqrt(1.0 - z * z);
    return {r * std::cos(a), r * std::sin(a), z};
  }
  double uniform() { return uniform_(engine_); }

 private:
  std::mt19937 engine_{7};
  std::uniform_real_distribution<double> uniform_{0.0, 1.0};
};

TEST_F(PathFunctionsTest, RandomNumbersAreTheReferencesBitByBit) {
  std::vector<Pair> inputs;
  for (int i = 0; i < 4096; ++i)
    inputs.push_back({glm::vec4(i * 7 % 1000, i, i % 6, i % 5), glm::vec4(i % 3, 0, 0, 0)});
  const std::vector<Pair> results = probe(0, inputs);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const auto word = [&](int k) { return static_cast<std::uint32_t>(inputs[i][0][k]); };
    const auto seed = static_cast<std::uint32_t>(inputs[i][1].x);
    const auto words = pcg4d({word(0), word(1), word(2), word(3) ^ seed});
    const auto unit = [](std::uint32_t w) { return static_cast<float>(w >> 8) / 16777216.0f; };
    EXPECT_EQ(results[i][0].z, static_cast<float>(words[0] >> 8));
    EXPECT_EQ(results[i][1].y, unit(words[3]));
    EXPECT_EQ(results[i][1].z, static_cast<float>(std::uint64_t{words[0]} * 1000 >> 32));
    glm::vec2 pair(unit(words[0]), unit(words[1]));
    if (word(2) < 4) {
      const auto seeds = pcg4d({word(0), 0xffffffffu, word(2), word(3) ^ seed});
      const std::uint32_t index = scrambled(word(1), seeds[0]);
      pair = {unit(scrambled(sobol(index, 0), seeds[1])), unit(scrambled(sobol(index, 1), seeds[2]))};
    }
    ASSERT_EQ(glm::vec2(results[i][0].x, results[i][0].y), pair) << i;
  }
}

// A (0,2)-sequence: of its first 256 points each elementary interval of area 1/256 holds exactly one.
TEST_F(PathFunctionsTest, FirstPairsAreEvenlySpread) {
  std::vector<Pair> inputs;
  for (int i = 0; i < 256; ++i) inputs.push_back({glm::vec4(12345, i, 2, 1), glm::vec4(0)});
  const std::vector<Pair> results = probe(0, inputs);
  for (int wide = 0; wide <= 8; ++wide) {
    std::vector<int> counts(256, 0);
    const int columns = 1 << wide, rows = 256 / columns;
    for (const Pair& r : results)
      ++counts[static_cast<std::size_t>(static_cast<int>(r[0].y * static_cast<float>(rows)) * columns +
                                        static_cast<int>(r[0].x * static_cast<float>(columns)))];
    EXPECT_EQ(counts, std::vector<int>(256, 1)) << columns;
  }
}

// The same, and each dimension alone holds one of 256 points in each 256th.
TEST_F(PathFunctionsTest, FurtherNumbersAreTheReferencesAndEvenlySpread) {
  std::vector<Pair> inputs;
  for (int i = 0; i < 1024; ++i)
    inputs.push_back({glm::vec4(i / 256 + 77, i % 256, 1, 3), glm::vec4(i / 512, 0, 0, 0)});
  const std::vector<Pair> results = probe(4, inputs);
  std::vector<int> counts(static_cast<std::size_t>(4 * 3 * 256), 0);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const auto pixel = static_cast<std::uint32_t>(i / 256 + 77), sample = static_cast<std::uint32_t>(i % 256);
    const auto seeds = pcg4d({pixel, 0xffffffffu, 1u, 3u ^ static_cast<std::uint32_t>(i / 512)}),
               further = pcg4d(seeds);
    for (int k = 0; k < 3; ++k) {
      const std::uint32_t word =
          scrambled(furtherSobol(scrambled(sample, seeds[0]) & 0xffffu, k), further[static_cast<std::size_t>(k)]);
      ASSERT_EQ(results[i][0][k], static_cast<float>(word >> 8)) << i << " " << k;
      ++counts[(i / 256 * 3 + static_cast<std::size_t>(k)) * 256 +
               static_cast<std::size_t>(results[i][0][k] / 65536.0f)];
    }
  }
  EXPECT_EQ(counts, std::vector<int>(counts.size(), 1));
}

TEST_F(PathFunctionsTest, MicrofacetsAndFresnelAreTheReferences) {
  std::vector<Pair> inputs;
  for (int i = 0; i < 4096; ++i) {
    const double alpha = std::pow(10.0, -2.0 + 2.0 * uniform()), eta = i % 2 ? 1.0 / 1.5 : 1.33;
    inputs.push_back({glm::vec4(glm::vec3(upper()), static_cast<float>(alpha)),
                      glm::vec4(glm::vec3(upper()), static_cast<float>(eta))});
  }
  const std::vector<Pair> results = probe(1, inputs);
  for (std::size_t k = 0; k < inputs.size(); ++k) {
    const glm::vec4 &a = inputs[k][0], &b = inputs[k][1];
    const glm::dvec3 o = glm::normalize(glm::dvec3(a)), i = glm::normalize(glm::dvec3(b));
    const Ggx ggx{a.w};
    const auto near = [&](double measured, double expected, double scale) {
      EXPECT_NEAR(measured, expected, 2e-4 * std::abs(expected) + 1e-6 * scale) << k << " alpha " << a.w;
    };
    near(results[k][0].x, ggx.reflect(o, i), 1.0);
    near(results[k][0].y, ggx.reflectPdf(o, i), 1.0);
    near(results[k][0].z, fresnel(o.z, b.w), 1.0);
    double pdf = 0.0;
    const double value = ggx.refract(o, {i.x, i.y, -i.z}, b.w, pdf);
    near(results[k][1].x, value, 1.0);
    near(results[k][1].y, pdf, 1.0);
    near(results[k][1].z, 0.04 + 0.96 * std::pow(1.0 - o.z, 5.0), 1.0);  // [Schlick1994]
    near(results[k][1].w, 0.9 + 0.1 * std::pow(1.0 - o.z, 5.0), 1.0);
    // Reciprocity of the reflection, and of the refraction over n^2: f(o, i) = f(i, o), where value is f times a
    // cosine.
    EXPECT_NEAR(ggx.reflect(o, i) / i.z, ggx.reflect(i, o) / o.z, 1e-9 * ggx.reflect(o, i) / i.z);
    double other = 0.0;
    const double back = ggx.refract(i, {o.x, o.y, -o.z}, 1.0 / b.w, other);
    if (value > 0.0 && back > 0.0) { EXPECT_NEAR(value / i.z * b.w * b.w, back / o.z, 1e-9 * back / o.z); }
  }
}

// Directions drawn, in 12 x 24 cells of cosine and azimuth, against the reference implementation's density integrated
// over each cell.
TEST_F(PathFunctionsTest, DrawnDirectionsHaveTheirDensity) {
  constexpr int kRows = 12, kColumns = 24, kSamples = 1 << 17, kFine = 12;
  struct Case {
    glm::dvec3 o;
    double alpha;  // 0: about the normal
  };
  for (const Case& c :
       {Case{glm::normalize(glm::dvec3(0.3, 0.2, 0.9)), 0.3}, Case{glm::normalize(glm::dvec3(0.9, 0.0, 0.25)), 0.6},
        Case{glm::normalize(glm::dvec3(-0.5, 0.6, 0.4)), 1.0}, Case{glm::dvec3(0, 0, 1), 0.0}}) {
    std::vector<Pair> inputs;
    for (int i = 0; i < kSamples; ++i)
      inputs.push_back({glm::vec4(glm::vec3(c.o), static_cast<float>(std::max(c.alpha, 0.1))),
                        glm::vec4(static_cast<float>(std::min(uniform(), 0.99999997)),
                                  static_cast<float>(std::min(uniform(), 0.99999997)), 0, 0)});
    const std::vector<Pair> results = probe(2, inputs);
    std::vector<double> counts(kRows * kColumns + 1, 0.0);  // the last: below
    for (std::size_t k = 0; k < results.size(); ++k) {
      const Pair& r = results[k];
      const double way = inputs[k][1].x, other = inputs[k][1].y;
      EXPECT_NEAR(r[1].w, way * way / (way * way + other * other), 1e-6);  // [Veach1997]
      const glm::dvec3 d = c.alpha > 0.0 ? glm::dvec3(r[0]) : glm::dvec3(r[1]);
      if (c.alpha > 0.0 && d.z > 1e-3) {
        EXPECT_NEAR(r[0].w, Ggx{c.alpha}.reflectPdf(c.o, glm::normalize(d)), 1e-3 * r[0].w + 1e-5);
      }
      const int row = std::min(static_cast<int>(d.z * kRows), kRows - 1);
      const int column =
          std::min(static_cast<int>((std::atan2(d.y, d.x) + kPi) / (2.0 * kPi) * kColumns), kColumns - 1);
      ++counts[static_cast<std::size_t>(d.z <= 0.0 ? kRows * kColumns : row * kColumns + column)];
    }
    std::vector<double> expected(counts.size(), 0.0);
    double left = 1.0;
    for (int row = 0; row < kRows; ++row)
      for (int column = 0; column < kColumns; ++column) {
        double sum = 0.0;
        for (int i = 0; i < kFine; ++i)
          for (int j = 0; j < kFine; ++j) {
            const double z = (row + (i + 0.5) / kFine) / kRows,
                         a = 2.0 * kPi * (column + (j + 0.5) / kFine) / kColumns - kPi, r = std::sqrt(1.0 - z * z);
            const glm::dvec3 d(r * std::cos(a), r * std::sin(a), z);
            sum += c.alpha > 0.0 ? Ggx{c.alpha}.reflectPdf(c.o, d) : z / kPi;
          }
        const double share = sum / (kFine * kFine) * 2.0 * kPi / (kRows * kColumns);
        expected[static_cast<std::size_t>(row * kColumns + column)] = share * kSamples;
        left -= share;
      }
    EXPECT_GT(left, -1e-3);
    if (c.alpha == 0.0) { EXPECT_NEAR(left, 0.0, 1e-6); }
    expected.back() = std::max(left, 0.0) * kSamples;
    double chi2 = 0.0, pooledExpected = 0.0, pooledCount = 0.0;
    int cells = 0;
    for (std::size_t k = 0; k < counts.size(); ++k) {
      if (expected[k] < 10.0) {
        pooledExpected += expected[k], pooledCount += counts[k];
        continue;
      }
      chi2 += (counts[k] - expected[k]) * (counts[k] - expected[k]) / expected[k];
      ++cells;
    }
    if (pooledExpected >= 10.0)
      chi2 += (pooledCount - pooledExpected) * (pooledCount - pooledExpected) / pooledExpected, ++cells;
    // Wilson and Hilferty's normal approximation; 3.72 standard deviations are 1e-4.
    const double n = cells - 1, limit = n * std::pow(1.0 - 2.0 / (9.0 * n) + 3.72 * std::sqrt(2.0 / (9.0 * n)), 3.0);
    EXPECT_LT(chi2, limit) << "alpha " << c.alpha << ", " << cells << " cells";
    EXPECT_GT(cells, 50);
  }
}

/// Angle between the planes through an edge: of b and c as seen along `a`.
double dihedral(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  const glm::dvec3 u = glm::cross(a, b), v = glm::cross(a, c);
  return std::atan2(glm::length(glm::cross(u, v)), glm::dot(u, v));
}

/// By Girard's theorem.
double sphericalExcess(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  return dihedral(a, b, c) + dihedral(b, c, a) + dihedral(c, a, b) - kPi;
}

// Solid angle, mean direction and shares of parts. The integral of directions over a spherical polygon is half the sum
// of its edges' angles times the normals of their planes (Lambert's formula as a vector).
TEST_F(PathFunctionsTest, DirectionsToATriangleAreUniformInItsSolidAngle) {
  const std::vector<std::array<glm::dvec3, 3>> triangles = {
      {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
      {{{1, 0.2, 0.3}, {0.1, 0.2, 1}, {-0.2, 1, 0.1}}},  // the other way round
      {{{0.01, 0, 1}, {0.04, 0.01, 1}, {0.02, 0.03, 1}}},
      {{{-0.9, -0.9, 0.02}, {1.1, -0.9, 0.02}, {0, 1.1, 0.02}}},  // seen from close to its plane
      {{{-0.5, 0, 1}, {0.5, 0, 1}, {0.1, 0.01, 1}}}};
  constexpr int kSide = 64;
  for (const auto& [far1, far2, far3] : triangles) {
    const glm::vec3 a(glm::normalize(far1)), b(glm::normalize(far2)), c(glm::normalize(far3));
    const glm::dvec3 middle = glm::normalize(glm::dvec3(b) + glm::dvec3(c));
    std::vector<Pair> inputs;
    for (int i = 0; i < kSide * kSide; ++i)
      inputs.push_back({glm::vec4(a, (static_cast<float>(i % kSide) + 0.5f) / kSide),
                        glm::vec4(b, (static_cast<float>(i / kSide) + 0.5f) / kSide)});
    const std::vector<Pair> results = probe(3, inputs, c);
    const double angle = sphericalExcess(a, b, c);
    const glm::dvec3 up = glm::cross(glm::dvec3(b - a), glm::dvec3(c - a));
    const double side = glm::dot(up, glm::dvec3(a)) > 0.0 ? 1.0 : -1.0;
    const auto inside = [&](const glm::dvec3& from, const glm::dvec3& to, const glm::dvec3& d) {
      return side * glm::dot(glm::normalize(glm::cross(from, to)), d);
    };
    glm::dvec3 sum(0.0);
    double ofPart = 0.0;
    for (const Pair& r : results) {
      const glm::dvec3 d(r[0]);
      EXPECT_NEAR(r[0].w, angle, 1e-4 * angle);
      EXPECT_NEAR(glm::length(d), 1.0, 1e-5);
      EXPECT_GT(std::min({inside(a, b, d), inside(b, c, d), inside(c, a, d)}), -1e-5);
      sum += d;
      ofPart += inside(a, middle, d) < 0.0 ? 1.0 : 0.0;
    }
    glm::dvec3 expected(0.0);
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
      const glm::dvec3 normal = glm::cross(glm::dvec3(from), glm::dvec3(to));
      expected += 0.5 * side / angle * std::atan2(glm::length(normal), glm::dot(glm::dvec3(from), glm::dvec3(to))) *
                  glm::normalize(normal);
    }
    const double spread = std::sqrt(angle);
    EXPECT_LT(glm::length(sum / (1.0 * kSide * kSide) - expected), 2e-3 * spread);
    EXPECT_NEAR(ofPart / (kSide * kSide), sphericalExcess(a, b, middle) / angle, 0.01);
  }
}

}  // namespace
}  // namespace lucerna::test
