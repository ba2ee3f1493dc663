// References: batches, their errors, merging, and the cache on disk; sampled from a known distribution.
#include "base/files.hpp"
#include "measure/image_errors.hpp"
#include "measure/reference.hpp"
#include "support/small_scenes.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <thread>

namespace {

using namespace lucerna;
using namespace lucerna::measure;

constexpr int kReferenceWidth = 24, kReferenceHeight = 16;
constexpr double kDeviation = 0.5;

float reference(int x, int y) { return 1.0f + 0.05f * static_cast<float>(x + y); }

/// A technique without bias: samples of standard deviation 0.5 about the reference, times `gain`. Reproducible by path
/// number.
Sampler noisy(double gain = 1.0, int* calls = nullptr) {
  return [gain, calls](std::uint64_t first, std::uint32_t samples) {
    if (calls) ++*calls;
    Image image(kReferenceWidth, kReferenceHeight);
    for (std::uint64_t s = first; s < first + samples; ++s) {
      std::mt19937_64 random(s * 0x9e3779b97f4a7c15u + 1);
      std::normal_distribution<double> normal(0.0, kDeviation);
      for (int y = 0; y < kReferenceHeight; ++y)
        for (int x = 0; x < kReferenceWidth; ++x)
          for (int c = 0; c < 3; ++c)
            image.at(x, y)[c] += static_cast<float>(gain * (reference(x, y) + normal(random)) / samples);
    }
    return image;
  };
}

Image exact(double gain = 1.0) {
  Image image(kReferenceWidth, kReferenceHeight);
  for (int y = 0; y < kReferenceHeight; ++y)
    for (int x = 0; x < kReferenceWidth; ++x) image.at(x, y) = glm::vec3(static_cast<float>(gain) * reference(x, y));
  return image;
}

Reference sample(const Sampler& sampler, std::uint64_t first, std::uint64_t samples) {
  SamplingGoal goal;
  goal.samples = samples;
  return sampleReference(sampler, Transport::all, first, goal).value();
}

JudgedErrors judge(const Image& image, const Reference& reference, double own = 0.0) {
  return lessNoise(errorsOf(image, reference.mean),
                   noiseOf(reference.mean, reference.standardError, reference.meanError), own);
}

TEST(Reference, ItsStandardErrorIsThatOfTheSamples) {
  const Reference r = sample(noisy(), 0, 256);
  EXPECT_EQ(r.samples, 256u);
  const ReferenceNoise noise = noiseOf(r.mean, r.standardError, r.meanError);
  // 1152 values of 15 degrees of freedom each: the mean variance is known to sqrt(2 / 15 / 1152) = 1.1 %; 5 of that.
  EXPECT_NEAR(noise.variance, kDeviation * kDeviation / 256.0, 0.055 * kDeviation * kDeviation / 256.0);
  // The mean's error comes from 16 batch means: chi with 15 degrees of freedom, within 0.45 .. 1.65 of the reference at
  // 1e-4 a side.
  const double expected = kDeviation / std::sqrt(256.0 * 3.0 * kReferenceWidth * kReferenceHeight);
  EXPECT_GT(r.meanError, 0.45 * expected);
  EXPECT_LT(r.meanError, 1.65 * expected);
  EXPECT_LT(std::abs(errorsOf(r.mean, exact()).bias), 4.5 * expected);
}

TEST(Reference, TwoOfItsPartsMakeTheWhole) {
  const Reference a = sample(noisy(), 0, 64), b = sample(noisy(), 64, 192), both = merged(a, b),
                  whole = sample(noisy(), 0, 256);
  EXPECT_EQ(both.samples, 256u);
  EXPECT_LT(errorsOf(both.mean, whole.mean).max, 1e-5);
  const double variance = noiseOf(both.mean, both.standardError, both.meanError).variance;
  EXPECT_NEAR(variance, kDeviation * kDeviation / 256.0, 0.055 * kDeviation * kDeviation / 256.0);
}

// What is exact differs from a sampled reference by the reference's noise alone, and must not be charged for it.
TEST(Reference, ItsNoiseIsNoTechniquesError) {
  const Reference r = sample(noisy(), 0, 256);
  const JudgedErrors judged = judge(exact(), r);
  EXPECT_GT(judged.measured.nrmse, 0.9 * judged.noiseNrmse);
  EXPECT_TRUE(judged.atNoise);
  EXPECT_TRUE(judged.biasAtNoise);
  EXPECT_LT(judged.nrmse, 0.5 * judged.noiseNrmse);
}

TEST(Reference, APlantedLossOfOnePercentIsCaught) {
  const Reference r = sample(noisy(), 0, 1024);
  const JudgedErrors whole = judge(exact(), r), loss = judge(exact(0.99), r);
  EXPECT_TRUE(whole.biasAtNoise);
  EXPECT_FALSE(loss.biasAtNoise) << loss.measured.bias << " +- " << loss.biasError;
  EXPECT_NEAR(loss.measured.relativeBias, -0.01, 3.0 * loss.biasError / loss.measured.referenceMean);
}

TEST(Reference, ASampledTechniquesOwnErrorCountsToo) {
  const Reference r = sample(noisy(), 0, 1024), few = sample(noisy(), 1u << 20, 16),
                  lossy = sample(noisy(0.9), 1u << 20, 256);
  EXPECT_TRUE(judge(few.mean, r, few.meanError).biasAtNoise);
  EXPECT_FALSE(judge(lossy.mean, r, lossy.meanError).biasAtNoise);
}

TEST(Reference, StopsWhenAskedAndNeedsTwoBatches) {
  int calls = 0;
  SamplingGoal goal;
  goal.samples = 64;
  EXPECT_FALSE(sampleReference(noisy(1.0, &calls), Transport::all, 0, goal, [&] { return calls >= 1; }));
  calls = 0;
  const auto cut = sampleReference(noisy(1.0, &calls), Transport::all, 0, goal, [&] { return calls >= 3; });
  ASSERT_TRUE(cut);
  EXPECT_EQ(cut->samples, 12u);  // batches of 4
}

// What is made once, such as programs: 60 ms of 200 that say nothing of how long a batch takes, 1 ms a sample. Batches
// have 8 samples then, not 1.
TEST(Reference, ByTimeTheFirstCallDecidesNoBatch) {
  int calls = 0;
  const Sampler slow = [&](std::uint64_t, std::uint32_t samples) {
    std::this_thread::sleep_for(std::chrono::milliseconds(++calls == 1 ? 60 : samples));
    return Image(2, 2, glm::vec3(1.0f));
  };
  SamplingGoal goal;
  goal.seconds = 0.2;
  ASSERT_TRUE(sampleReference(slow, Transport::direct, 0, goal));
  EXPECT_GE(calls, 16 + 1);
  EXPECT_LT(calls, 60);
}

TEST(Reference, ByTimeItMakesBatchesEnough) {
  SamplingGoal goal;
  goal.seconds = 0.05;
  const auto r = sampleReference(noisy(), Transport::direct, 0, goal);
  ASSERT_TRUE(r);
  EXPECT_GE(r->samples, 16u);
  EXPECT_EQ(r->transport, Transport::direct);
}

// ---- the key ----

TEST(ReferenceKey, FollowsContentAndNothingElse) {
  const Scene scene = test::openBox();
  const Camera camera = test::openBoxCamera();
  const auto key = [](const Scene& s, const Camera& c, glm::ivec2 size = {8, 8}, Transport t = Transport::all,
                      const char* sampler = "v1") { return keyOf(s, c, size, t, sampler).name(); };
  const std::string first = key(scene, camera);
  Scene other = scene;
  other.name = "renamed", other.exposure = 3.0f;
  EXPECT_EQ(key(other, camera), first);
  const auto changed = [&](auto change) {
    Scene s = scene;
    change(s);
    return key(s, camera);
  };
  EXPECT_NE(changed([](Scene& s) { s.vertices[0].position.x += 1e-3f; }), first);
  EXPECT_NE(changed([](Scene& s) { s.materials[0].diffuse.y += 1e-3f; }), first);
  EXPECT_NE(changed([](Scene& s) { s.materials[0].bsdf = Bsdf::mirror; }), first);
  EXPECT_NE(changed([](Scene& s) { s.sun->irradiance.z += 1e-3f; }), first);
  EXPECT_NE(changed([](Scene& s) { s.media.emplace_back(); }), first);
  EXPECT_NE(changed([](Scene& s) { s.textures.emplace_back().bitmap.rgba = {1, 2, 3, 4}; }), first);
  const auto wrapped = [&](TextureWraps wraps) {
    return changed([&](Scene& s) { s.textures.emplace_back().wraps = wraps; });
  };
  const std::string repeated = wrapped({}), clamped = wrapped({TextureWrap::edge, TextureWrap::repeat});
  EXPECT_NE(clamped, repeated);
  EXPECT_NE(clamped, wrapped({TextureWrap::repeat, TextureWrap::edge}));
  EXPECT_NE(clamped, wrapped({TextureWrap::mirror, TextureWrap::repeat}));
  EXPECT_NE(wrapped({TextureWrap::repeat, TextureWrap::edge}), wrapped({TextureWrap::repeat, TextureWrap::mirror}));
  EXPECT_NE(changed([](Scene& s) { s.environment.emplace(); }), first);
  Camera turned = camera;
  turned.verticalFov += 1e-6;
  EXPECT_NE(key(scene, turned), first);
  EXPECT_NE(key(scene, camera, {8, 9}), first);
  EXPECT_NE(key(scene, camera, {8, 8}, Transport::direct), first);
  EXPECT_NE(key(scene, camera, {8, 8}, Transport::all, "v2"), first);
}

// ---- the cache ----

TEST(ReferenceCache, GivesBackWhatWasStored) {
  const test::TempFolder folder;
  const ReferenceCache cache(folder / "made/here");
  Reference r = sample(noisy(), 0, 32);
  r.renderer = "a renderer";
  const ReferenceKey key{42};
  EXPECT_FALSE(cache.load(key));
  cache.store(key, r);
  const auto back = cache.load(key);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->mean.pixels, r.mean.pixels);
  EXPECT_EQ(back->standardError.pixels, r.standardError.pixels);
  EXPECT_EQ(back->meanError, r.meanError);
  EXPECT_EQ(back->samples, 32u);
  EXPECT_EQ(back->renderer, "a renderer");
  EXPECT_FALSE(cache.load({43}));
}

TEST(ReferenceCache, DamageIsSeenWhereverItIs) {
  const test::TempFolder folder;
  const ReferenceCache cache(folder.path());
  const ReferenceKey key{7};
  cache.store(key, sample(noisy(), 0, 16));
  const std::vector<std::uint8_t> whole = readFileBytes(cache.fileOf(key));
  for (std::size_t at :
       {std::size_t{0}, std::size_t{9}, std::size_t{33}, std::size_t{60}, whole.size() / 2, whole.size() - 1}) {
    std::vector<std::uint8_t> bytes = whole;
    bytes[at] ^= 1;
    writeFileAtomically(cache.fileOf(key), bytes);
    EXPECT_FALSE(cache.load(key)) << at;
  }
  for (std::size_t size : {std::size_t{0}, std::size_t{10}, std::size_t{70}, whole.size() - 1}) {
    writeFileAtomically(cache.fileOf(key), std::span(whole).first(size));
    EXPECT_FALSE(cache.load(key)) << size;
  }
  // A whole file under another's name is not that one's.
  writeFileAtomically(cache.fileOf({8}), whole);
  EXPECT_FALSE(cache.load({8}));
}

TEST(ReferenceCache, AFolderThatCannotBeIsOneClearLine) {
  const test::TempFolder folder;
  folder.write("file", "x");
  const std::string message = test::badInputMessage([&] { ReferenceCache(folder / "file"); });
  EXPECT_NE(message.find("file"), std::string::npos);
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

TEST(ReferenceCache, IsUsedWhereItMeetsTheGoalAndSampledFurtherWhereNot) {
  const test::TempFolder folder;
  const ReferenceCache cache(folder.path());
  int calls = 0;
  const Sampler sampler = noisy(1.0, &calls);
  SamplingGoal goal;
  goal.samples = 32;
  const auto first = obtainReference(cache, {1}, sampler, Transport::all, goal, "here");
  EXPECT_EQ(calls, 16);
  const auto again = obtainReference(cache, {1}, sampler, Transport::all, goal, "here");
  EXPECT_EQ(calls, 16);
  EXPECT_EQ(again->mean.pixels, first->mean.pixels);
  goal.samples = 96;
  const auto more = obtainReference(cache, {1}, sampler, Transport::all, goal, "here");
  EXPECT_EQ(more->samples, 96u);
  EXPECT_LT(errorsOf(more->mean, sample(noisy(), 0, 96).mean).max, 1e-5);  // the same paths, none of them twice
  EXPECT_EQ(cache.load({1})->samples, 96u);
}

// Stopped after any number of batches, by number of samples: the next call ends with the bits of one that was not
// stopped, makes no batch twice, and leaves no file behind but the reference.
TEST(ReferenceCache, AStoppedReferenceGoesOnToTheSameBits) {
  const Sampler plain = noisy();
  for (const std::uint64_t samples : {4u, 64u}) {
    SamplingGoal goal;
    goal.samples = samples;
    const test::TempFolder wholeFolder;
    const auto whole =
        obtainReference(ReferenceCache(wholeFolder.path()), {1}, plain, Transport::all, goal, "here").value();
    for (const int stopAfter : {1, 5, 15}) {
      const test::TempFolder folder;
      const ReferenceCache cache(folder.path());
      int calls = 0;
      const Sampler sampler = noisy(1.0, &calls);
      EXPECT_FALSE(
          obtainReference(cache, {1}, sampler, Transport::all, goal, "here", [&] { return calls >= stopAfter; }));
      EXPECT_FALSE(cache.load({1}));
      const auto resumed = obtainReference(cache, {1}, sampler, Transport::all, goal, "here");
      ASSERT_TRUE(resumed);
      EXPECT_EQ(calls, 16);
      EXPECT_EQ(resumed->mean.pixels, whole.mean.pixels) << stopAfter;
      EXPECT_EQ(resumed->standardError.pixels, whole.standardError.pixels);
      EXPECT_EQ(resumed->meanError, whole.meanError);
      EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
    }
  }
}

// What was begun for another goal, or is damaged, is not gone on from.
TEST(ReferenceCache, WhatWasBegunForAnotherGoalIsNotTakenUp) {
  const test::TempFolder folder;
  const ReferenceCache cache(folder.path());
  int calls = 0;
  const Sampler sampler = noisy(1.0, &calls);
  SamplingGoal goal;
  goal.samples = 64;
  const auto stopAfterThree = [&] { return calls >= 3; };
  EXPECT_FALSE(obtainReference(cache, {1}, sampler, Transport::all, goal, "here", stopAfterThree));
  const UnfinishedReference begun{.first = 0, .size = 4};
  ASSERT_TRUE(cache.load({1}, begun));
  EXPECT_EQ(cache.load({1}, begun)->mean.batches(), 3);
  EXPECT_FALSE(cache.load({2}, begun));
  EXPECT_FALSE(cache.load({1}, UnfinishedReference{.first = 4, .size = 4}));
  EXPECT_FALSE(cache.load({1}, UnfinishedReference{.first = 0, .size = 8}));
  const std::filesystem::path file = folder.path() / (ReferenceKey{1}.name() + ".unfinished");
  std::fstream(file, std::ios::binary | std::ios::in | std::ios::out).seekp(200).put('x');
  EXPECT_FALSE(cache.load({1}, begun));
  std::filesystem::resize_file(file, 40);
  EXPECT_FALSE(cache.load({1}, begun));
}

}  // namespace
