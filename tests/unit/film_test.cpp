// Films of parts of a picture's samples, and what they come to together (no GL).
#include "base/error.hpp"
#include "pathtracer/film.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

namespace {

using namespace lucerna;

glm::uvec4 wordsOf(glm::dvec3 v, std::uint32_t w) {
  const glm::vec3 f(v);
  return {std::bit_cast<std::uint32_t>(f.x), std::bit_cast<std::uint32_t>(f.y), std::bit_cast<std::uint32_t>(f.z), w};
}

constexpr int kFilmWidth = 3, kFilmHeight = 2;

/// What a tracer would have made of samples first .. last: the same numbers whoever makes them.
Film filmOfSamples(std::uint32_t first, std::uint32_t last, std::uint64_t identity = 7) {
  Film film;
  film.identity = identity;
  film.size = {kFilmWidth, kFilmHeight};
  film.first = first;
  for (std::uint32_t pixel = 0; pixel < kFilmWidth * kFilmHeight; ++pixel) {
    glm::dvec3 sum(0.0), squares(0.0);
    std::vector<glm::dvec3> values;
    for (std::uint32_t s = first; s < last; ++s) {
      std::mt19937 random(1000 * s + pixel);
      std::lognormal_distribution<double> radiance(0.0, 1.5);
      values.push_back({radiance(random), radiance(random), 10.0 + radiance(random)});
      sum += values.back();
    }
    const double n = last - first;
    const glm::dvec3 mean = sum / n;
    for (const glm::dvec3& v : values) squares += (v - mean) * (v - mean);
    film.mean.push_back(wordsOf(mean, last - first));
    film.rest.push_back(wordsOf(mean - glm::dvec3(glm::vec3(mean)), 0));
    film.m2.push_back(wordsOf(squares, 0));
  }
  return film;
}

Film merged(const std::vector<Film>& films) {
  FilmMerge merge;
  for (std::size_t i = 0; i < films.size(); ++i) merge.add(films[i], "part" + std::to_string(i));
  return merge.result();
}

void expectRefused(const std::vector<Film>& films, const std::string& word) {
  try {
    merged(films);
    FAIL() << "not refused: " << word;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::badInput);
    EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
  }
}

TEST(Film, PartsTogetherAreOneRun) {
  const Film whole = filmOfSamples(0, 1000), sum = merged({filmOfSamples(0, 17), filmOfSamples(17, 400),
                                                           filmOfSamples(400, 401), filmOfSamples(401, 1000)});
  EXPECT_EQ(sum.first, 0u);
  for (std::size_t i = 0; i < whole.mean.size(); ++i) {
    const FilmPixel a = whole.pixels()[i], b = sum.pixels()[i];
    EXPECT_EQ(b.samples, 1000u);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(b.mean[c] / a.mean[c], 1.0, 1e-6);
      EXPECT_NEAR(standardErrorOf(b)[c] / standardErrorOf(a)[c], 1.0, 1e-5);
    }
  }
  const FilmStatistics statistics = statisticsOf(sum.pixels());
  EXPECT_NEAR(statistics.standardError / statisticsOf(whole.pixels()).standardError, 1.0, 1e-6);
  EXPECT_EQ(merged({filmOfSamples(40, 50), filmOfSamples(50, 60)}).first, 40u);
}

TEST(Film, WhatDoesNotBelongTogetherIsRefused) {
  expectRefused({filmOfSamples(0, 10), filmOfSamples(5, 15)}, "the same samples (5 to 9)");
  expectRefused({filmOfSamples(0, 10), filmOfSamples(0, 10)}, "the same samples (0 to 9)");
  expectRefused({filmOfSamples(0, 10), filmOfSamples(12, 20)}, "samples 10 to 11 are in no part");
  expectRefused({filmOfSamples(0, 10), filmOfSamples(10, 20, 8)}, "another scene, view or setting");
  Film small = filmOfSamples(10, 20);
  small.size = {1, 6};
  expectRefused({filmOfSamples(0, 10), small}, "pixels");
  Film unfinished = filmOfSamples(10, 20);
  unfinished.mean[3].w = 9;
  expectRefused({filmOfSamples(0, 10), unfinished}, "not finished");
}

TEST(Film, BytesAreReadBackAndDamageIsSeen) {
  const Film film = filmOfSamples(5, 9);
  std::vector<std::uint8_t> bytes = bytesOf(film);
  const Film read = filmOf(bytes, "memory");
  EXPECT_EQ(read.first, 5u);
  EXPECT_EQ(read.identity, film.identity);
  EXPECT_EQ(read.size, film.size);
  EXPECT_EQ(read.mean, film.mean);
  EXPECT_EQ(read.m2, film.m2);
  EXPECT_EQ(read.rest, film.rest);
  for (const std::size_t at :
       {std::size_t{0}, std::size_t{32}, bytes.size() - 1}) {  // the kind of file, the first sample, the last word
    std::vector<std::uint8_t> damaged = bytes;
    damaged[at] ^= 1;
    EXPECT_THROW(filmOf(damaged, "memory"), Error) << at;
  }
  bytes.pop_back();
  EXPECT_THROW(filmOf(bytes, "memory"), Error);
}

TEST(Film, PixelsThatFoundNothingAreNotExact) {
  const auto pixel = [](float mean, std::uint32_t samples) {
    return FilmPixel{glm::vec3(mean), glm::vec3(0.0f), samples};
  };
  const std::vector<FilmPixel> black(16, pixel(0.0f, 4));
  EXPECT_TRUE(std::isinf(statisticsOf(black).relativeError));
  // Half of the pixels shine without noise, half are black: of n samples there, three may find as much.
  for (const std::uint32_t n : {4u, 64u}) {
    std::vector<FilmPixel> half(8, pixel(2.0f, n));
    half.resize(16, pixel(0.0f, n));
    EXPECT_NEAR(statisticsOf(half).relativeError, std::sqrt(0.5 * 3.0) * 2.0 / n, 1e-9) << n;
    EXPECT_EQ(statisticsOf(half).meanError, glm::dvec3(0.0));
  }
  EXPECT_EQ(statisticsOf(std::vector<FilmPixel>(16, pixel(1.0f, 4))).relativeError, 0.0);
  const auto text = [](const std::vector<FilmPixel>& pixels) {
    const FilmStatistics s = statisticsOf(pixels);
    return standardErrorText(s.standardError, s.relativeError);
  };
  EXPECT_EQ(text(black), "standard error not known, as no light was found");
  EXPECT_EQ(text(std::vector<FilmPixel>(16, pixel(1.0f, 1))), "standard error not known, from one sample");
  EXPECT_EQ(text(std::vector<FilmPixel>(16, pixel(1.0f, 4))), "standard error of a pixel 0 (0 of the mean)");
}

}  // namespace
