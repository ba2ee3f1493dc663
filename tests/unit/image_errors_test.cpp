// Image errors, the Pareto front and the slope against figures worked out by hand; heat maps and FLIP against their
// definitions.
#include "measure/flip.hpp"
#include "measure/front.hpp"
#include "measure/heat_map.hpp"
#include "measure/image_errors.hpp"
#include "support/temp_folder.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <limits>

namespace {

using namespace lucerna;
using namespace lucerna::measure;

Image picture(std::initializer_list<glm::vec3> pixels) {
  Image image(static_cast<int>(pixels.size()), 1);
  image.pixels.assign(pixels.begin(), pixels.end());
  return image;
}

// d = (1 0 0), (0 -2 0): squares 1 + 4 over 6; reference mean (1 + 1 + 1 + 2 + 4 + 3) / 6 = 2.
TEST(ImageErrors, AreThoseOfTheFormulas) {
  const Image reference = picture({{1, 1, 1}, {2, 4, 3}}), image = picture({{2, 1, 1}, {2, 2, 3}});
  const ImageErrors e = errorsOf(image, reference);
  EXPECT_DOUBLE_EQ(e.referenceMean, 2.0);
  EXPECT_NEAR(e.rmse, std::sqrt(5.0 / 6.0), 1e-12);
  EXPECT_NEAR(e.nrmse, std::sqrt(5.0 / 6.0) / 2.0, 1e-12);
  EXPECT_NEAR(e.relmse, (1.0 / 1.04 + 4.0 / 16.04) / 6.0, 1e-12);  // epsilon: 0.01 * 2^2
  EXPECT_NEAR(e.bias, -1.0 / 6.0, 1e-12);
  EXPECT_NEAR(e.relativeBias, -1.0 / 12.0, 1e-12);
  EXPECT_NEAR(e.channelBias.x, 0.5, 1e-12);
  EXPECT_NEAR(e.channelBias.y, -1.0, 1e-12);
  EXPECT_DOUBLE_EQ(e.max, 2.0);
  EXPECT_NEAR(e.p99, 1.99, 1e-12);  // between the pixels' 1 and 2
}

TEST(ImageErrors, DoNotDependOnUnits) {
  const Image reference = picture({{1, 2, 3}, {4, 0, 1}}), image = picture({{1.5f, 2, 2}, {3, 0.5f, 1}});
  Image bright = reference, brightImage = image;
  for (glm::vec3& p : bright.pixels) p *= 1024.0f;
  for (glm::vec3& p : brightImage.pixels) p *= 1024.0f;
  const ImageErrors a = errorsOf(image, reference), b = errorsOf(brightImage, bright);
  EXPECT_DOUBLE_EQ(a.nrmse, b.nrmse);
  EXPECT_DOUBLE_EQ(a.relmse, b.relmse);
  EXPECT_DOUBLE_EQ(a.relativeBias, b.relativeBias);
  EXPECT_DOUBLE_EQ(1024.0 * a.rmse, b.rmse);
}

TEST(ImageErrors, EqualAndBlackPicturesHaveNone) {
  const Image black(3, 2);
  const ImageErrors e = errorsOf(black, black);
  EXPECT_EQ(e.rmse, 0.0);
  EXPECT_EQ(e.nrmse, 0.0);
  EXPECT_EQ(e.relmse, 0.0);
  EXPECT_EQ(e.relativeBias, 0.0);
}

TEST(ImageErrors, NotFinitePixelsAreCountedAndShownNotClampedAway) {
  Image image(2, 1, glm::vec3(1.0f));
  image.pixels[1].y = std::numeric_limits<float>::quiet_NaN();
  const ImageErrors e = errorsOf(image, Image(2, 1, glm::vec3(1.0f)));
  EXPECT_EQ(e.notFinite, 1u);
  EXPECT_TRUE(std::isnan(e.rmse));
  EXPECT_TRUE(std::isnan(e.max));
  EXPECT_TRUE(std::isnan(lessNoise(e, {}).nrmse));
  EXPECT_FALSE(lessNoise(e, {}).atNoise);
}

TEST(ImageErrors, OtherSizesAreRefused) {
  EXPECT_NE(test::badInputMessage([] { errorsOf(Image(2, 1), Image(1, 2)); }).find("2x1"), std::string::npos);
  EXPECT_FALSE(test::badInputMessage([] { errorsOf(Image(), Image()); }).empty());
}

TEST(ImageErrors, TheReferencesNoiseIsTakenOff) {
  const Image reference = picture({{1, 1, 1}, {1, 1, 1}}), image = picture({{1.5f, 1.5f, 1.5f}, {1.5f, 1.5f, 1.5f}});
  const Image standardError(2, 1, glm::vec3(0.3f));
  const ReferenceNoise noise = noiseOf(reference, standardError, 0.05);
  EXPECT_NEAR(noise.variance, 0.09, 1e-7);
  EXPECT_NEAR(noise.relativeVariance, 0.09 / 1.01, 1e-7);
  const JudgedErrors judged = lessNoise(errorsOf(image, reference), noise, 0.12);
  EXPECT_NEAR(judged.nrmse, std::sqrt(0.25 - 0.09), 1e-7);
  EXPECT_NEAR(judged.relmse, 0.16 / 1.01, 1e-7);
  EXPECT_NEAR(judged.noiseNrmse, 0.3, 1e-7);
  EXPECT_NEAR(judged.biasError, 0.13, 1e-12);
  EXPECT_TRUE(judged.atNoise);  // 0.5 < 3 * 0.3
  EXPECT_FALSE(judged.biasAtNoise);  // 0.5 > 3 * 0.13
}

// d^2: 1 + 4; r^2: 3 (1) and 4 + 16 + 9.
TEST(RelativeL2, IsThatOfTheFormula) {
  const Image reference = picture({{1, 1, 1}, {2, 4, 3}}), image = picture({{2, 1, 1}, {2, 2, 3}});
  EXPECT_NEAR(errorsOf(image, reference).l2, std::sqrt(5.0 / 32.0), 1e-12);
  EXPECT_NEAR(errorsOf(image, reference).referenceSquare, 32.0 / 6.0, 1e-12);
}

// A black picture has 1, whatever part of the picture is background; NRMSE has sqrt(2) with half of it, and 2 with
// three quarters.
TEST(RelativeL2, OfABlackPictureIsOneWhateverTheBackground) {
  const glm::vec3 grey(0.4f), none(0.0f);
  for (const Image& reference :
       {picture({grey}), picture({grey, none}), picture({grey, none, none, none}), picture({{1, 2, 3}, {4, 0, 1}})}) {
    const Image black(reference.width, 1);
    EXPECT_NEAR(errorsOf(black, reference).l2, 1.0, 1e-12);
    // Nor does the reference's noise change that.
    const Image standardError(reference.width, 1, glm::vec3(0.1f));
    const JudgedErrors judged = lessNoise(errorsOf(black, reference), noiseOf(reference, standardError, 0.0));
    EXPECT_NEAR(judged.l2, 1.0, 1e-12);
    EXPECT_NEAR(judged.noiseL2, 0.1 / std::sqrt(errorsOf(black, reference).referenceSquare), 1e-7);
  }
  EXPECT_NEAR(errorsOf(Image(2, 1), picture({grey, none})).nrmse, std::sqrt(2.0), 1e-6);
  EXPECT_NEAR(errorsOf(Image(4, 1), picture({grey, none, none, none})).nrmse, 2.0, 1e-6);
  EXPECT_EQ(errorsOf(Image(2, 1), Image(2, 1)).l2, 0.0);
}

TEST(Blocks, HaveASixteenthOfTheWidth) {
  EXPECT_EQ(blockSide(160), 10);
  EXPECT_EQ(blockSide(96), 6);
  EXPECT_EQ(blockSide(5), 1);
}

// An error that alternates within blocks is gone in their means; one that is the same everywhere stays.
TEST(Blocks, OfACheckerboardHaveNoError) {
  const Image reference(32, 18, glm::vec3(2.0f));
  Image checkerboard = reference, brighter(32, 18, glm::vec3(2.5f));
  for (int y = 0; y < 18; ++y)
    for (int x = 0; x < 32; ++x) checkerboard.at(x, y) += glm::vec3((x + y) % 2 ? 0.5f : -0.5f);
  EXPECT_NEAR(errorsOf(checkerboard, reference).l2, 0.25, 1e-12);
  EXPECT_EQ(errorsOf(blockMeans(checkerboard, 2), blockMeans(reference, 2)).l2, 0.0);
  EXPECT_NEAR(errorsOf(blockMeans(brighter, 2), blockMeans(reference, 2)).l2, 0.25, 1e-12);
}

// 3x2 in blocks of 2x2: the last is cut off at the edge and has two pixels.
TEST(Blocks, AreCutOffAtTheEdgeAndKeepTheMean) {
  Image image(3, 2);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) image.at(x, y) = glm::vec3(static_cast<float>(x + 3 * y));
  const Image blocks = blockMeans(image, 2);
  EXPECT_FLOAT_EQ(blocks.at(0, 0).x, 2.0f);  // 0 1 3 4
  EXPECT_FLOAT_EQ(blocks.at(1, 1).x, 2.0f);
  EXPECT_FLOAT_EQ(blocks.at(2, 0).x, 3.5f);  // 2 5
  EXPECT_NEAR(meanOf(blocks).x, meanOf(image).x, 1e-6);
  const Image errors = blockStandardErrors(Image(3, 2, glm::vec3(0.6f)), 2);
  EXPECT_FLOAT_EQ(errors.at(0, 0).y, 0.3f);
  EXPECT_FLOAT_EQ(errors.at(2, 1).y, static_cast<float>(0.6 / std::sqrt(2.0)));
}

TEST(Blocks, ChangeRelativeToThemselvesOrToThePicturesMean) {
  // 3 by 2 blocks and a rest of 8 columns; one block is dark.
  Image before(56, 32);
  for (int y = 0; y < 32; ++y)
    for (int x = 0; x < 56; ++x) before.at(x, y) = x < 16 && y < 16 ? glm::vec3(0.01f) : glm::vec3(1.0f, 2.0f, 3.0f);
  const double mean = (6.0 * (56 * 32 - 256) + 0.03 * 256) / (56 * 32);
  const auto changed = [&](int x, int y, int columns, const glm::vec3& by) {
    Image after = before;
    for (int j = y; j < y + 16; ++j)
      for (int i = x; i < x + columns; ++i) after.at(i, j) += by;
    return changeBetween(before, after);
  };
  const glm::vec3 half(0.0f, 0.5f, 0.0f);
  EXPECT_EQ(changeBetween(before, before).block, 0.0);
  EXPECT_EQ(changeBetween(before, before).mean, 0.0);
  EXPECT_NEAR(changed(16, 0, 16, half).block, 0.5 / 6.0, 1e-6);
  EXPECT_NEAR(changed(16, 0, 16, -half).block, 0.5 / 6.0, 1e-6);
  EXPECT_NEAR(changed(16, 0, 16, half).mean, 0.5 * 256 / (mean * 56 * 32), 1e-6);
  EXPECT_NEAR(changed(24, 16, 16, half).block, 0.25 / 6.0, 1e-6);  // half of two blocks
  EXPECT_NEAR(changed(0, 0, 16, half).block, 0.5 / mean, 1e-6);  // dark
  EXPECT_NEAR(changed(16, 0, 16, {0.5f, -0.5f, 0.0f}).block, 0.0, 1e-6);
  EXPECT_EQ(changed(48, 0, 8, half).block, 0.0);  // cut off by the edge
  EXPECT_GT(changed(48, 0, 8, half).mean, 0.0);
  // What cannot be told is not taken for no change.
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    EXPECT_TRUE(std::isinf(changed(16, 0, 1, glm::vec3(bad)).block));
    EXPECT_TRUE(std::isinf(changed(16, 0, 1, glm::vec3(bad)).mean));
  }
  const Image black(56, 32);
  EXPECT_TRUE(std::isinf(changeBetween(black, before).block));
  EXPECT_EQ(changeBetween(black, black).block, 0.0);
}

// Lit pixels 1 -> 3, the others 2 -> 1: one figure (mean -> +14 %) would hide +200 % and -50 %. Squares: 3 * 4 against
// 3 * 2 * 1.
TEST(Parts, HaveTheirOwnBiases) {
  const Image reference = picture({glm::vec3(1), glm::vec3(2), glm::vec3(2), glm::vec3(2)}),
              image = picture({glm::vec3(3), glm::vec3(1), glm::vec3(1), glm::vec3(2)});
  const Image standardError(4, 1, glm::vec3(0.3f));
  const PartErrors lit = partErrorsOf(image, reference, standardError, {true, false, false, false}),
                   other = partErrorsOf(image, reference, standardError, {false, true, true, false});
  EXPECT_NEAR(lit.relativeBias, 2.0, 1e-12);
  EXPECT_NEAR(other.relativeBias, -0.5, 1e-12);
  EXPECT_NEAR(lit.squares, 12.0 / 18.0, 1e-12);
  EXPECT_NEAR(other.squares, 6.0 / 18.0, 1e-12);
  EXPECT_NEAR(lit.pixels, 0.25, 1e-12);
  EXPECT_NEAR(other.pixels, 0.5, 1e-12);
  EXPECT_NEAR(lit.biasError, 0.3, 1e-7);  // over 1
  EXPECT_NEAR(other.biasError, 0.3 * std::sqrt(2.0) / 4.0, 1e-7);  // over 2 + 2
  // A picture with a mean error of 0.1 over four pixels: 0.2 a pixel, as if all were as noisy.
  EXPECT_NEAR(partErrorsOf(image, reference, standardError, {true, false, false, false}, 0.1).biasError,
              std::hypot(0.3, 0.2), 1e-7);
  const PartErrors none = partErrorsOf(image, reference, standardError, {false, false, false, false});
  EXPECT_TRUE(std::isnan(none.relativeBias));
  EXPECT_EQ(none.squares, 0.0);
}

// The reference's noise moves a measured square by 2 d s sqrt(1 + s^2 / (2 d^2)): here the measured d^2 is d^2 + s^2,
// three channels of one pixel go together, two pixels do not.
TEST(SquareErrors, FollowTheReferencesNoise) {
  const double s = 0.01, d = 0.3;
  const Image reference(2, 1, glm::vec3(1.0f)), image(2, 1, glm::vec3(1.0f + static_cast<float>(std::hypot(d, s))));
  const SquareErrors errors = squareErrorsOf(image, reference, Image(2, 1, glm::vec3(static_cast<float>(s))));
  const double one = std::sqrt((4.0 * d * d + 2.0 * s * s) * s * s);
  EXPECT_NEAR(errors.squares, one / std::sqrt(2.0), 1e-6 * one);
  EXPECT_NEAR(errors.relative, one / std::sqrt(2.0) / (1.0 + kRelativeEpsilon), 1e-6 * one);
  EXPECT_EQ(squareErrorsOf(image, reference, Image(2, 1)).squares, 0.0);
}

// The same by drawing references: their spread is what is foretold, to a tenth of it (2000 draws: standard error 1.6
// %).
TEST(SquareErrors, AreWhatDrawnReferencesShow) {
  constexpr int kPixels = 200, kDraws = 2000;
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  Image exact(kPixels, 1), picture(kPixels, 1), error(kPixels, 1);
  for (int i = 0; i < kPixels; ++i) {
    exact.at(i, 0) = glm::vec3(1.0f + 0.01f * static_cast<float>(i));
    picture.at(i, 0) = exact.at(i, 0) * (i % 2 ? 1.2f : 0.95f);
    error.at(i, 0) = 0.05f * exact.at(i, 0);
  }
  double sum = 0.0, squares = 0.0, foretold = 0.0;
  for (int n = 0; n < kDraws; ++n) {
    Image reference = exact;
    for (int i = 0; i < kPixels; ++i) reference.at(i, 0) += normal(random) * error.at(i, 0);  // channels as one
    const double rmse = errorsOf(picture, reference).rmse;
    sum += rmse * rmse;
    squares += rmse * rmse * rmse * rmse;
    foretold += squareErrorsOf(picture, reference, error).squares / kDraws;
  }
  const double mean = sum / kDraws, spread = std::sqrt(squares / kDraws - mean * mean);
  EXPECT_NEAR(foretold / spread, 1.0, 0.1);
}

// Two errors that their spreads explain are equal: the cheaper one stays. What is clearly better joins, even where a
// row between them was equal to both.
TEST(Front, RowsThatCannotBeToldApartAreEqual) {
  const std::vector<CostAndError> exact{{1, 0.5}, {2, 0.4999}, {3, 0.3}, {4, 0.31}};
  EXPECT_EQ(paretoFront(exact), (std::vector<bool>{true, true, true, false}));
  std::vector<CostAndError> points = exact;
  for (CostAndError& p : points) p.standardError = 0.01;
  EXPECT_EQ(paretoFront(points), (std::vector<bool>{true, false, true, false}));
  const std::vector<CostAndError> chain{{1, 0.50, 0, 0.02}, {2, 0.46, 0, 0.02}, {3, 0.42, 0, 0.02}};
  EXPECT_EQ(paretoFront(chain), (std::vector<bool>{true, false, true}));
  // As dear within its spread, and clearly worse: off the front.
  const std::vector<CostAndError> times{{1.0, 0.5, 0.1, 0.01}, {1.1, 0.3, 0.1, 0.01}};
  EXPECT_EQ(paretoFront(times), (std::vector<bool>{false, true}));
}

TEST(ConstantIrradiance, OfAPictureThatIsOneIsFound) {
  const Image albedo = picture({{0.8f, 0.5f, 0.1f}, {0.3f, 0.3f, 0.3f}, {0, 0, 0}});
  const Image lit = litByConstant(albedo, {3.0, 2.0, 1.0});
  const glm::dvec3 found = constantIrradiance(albedo, lit);
  EXPECT_NEAR(found.x, 3.0, 1e-6);
  EXPECT_NEAR(found.y, 2.0, 1e-6);
  EXPECT_NEAR(found.z, 1.0, 1e-6);
  EXPECT_NEAR(errorsOf(litByConstant(albedo, found), lit).l2, 0.0, 1e-7);
  EXPECT_NEAR(lit.pixels[0].x, 0.8 * 3.0 / 3.14159265358979323846, 1e-6);
}

// Albedo 1 and 2 (as numbers go), pictures 1 and 1: E / pi = 3/5, what is left 4/25 + 1/25 of 2. No other constant
// comes nearer.
TEST(ConstantIrradiance, IsTheLeastSquares) {
  const Image albedo = picture({glm::vec3(1), glm::vec3(2)}), reference = picture({glm::vec3(1), glm::vec3(1)});
  const glm::dvec3 best = constantIrradiance(albedo, reference);
  EXPECT_NEAR(best.x, 3.14159265358979323846 * 0.6, 1e-9);
  const double error = errorsOf(litByConstant(albedo, best), reference).l2;
  EXPECT_NEAR(error, std::sqrt(0.2 / 2.0), 1e-6);
  for (const double factor : {0.95, 1.05})
    EXPECT_GT(errorsOf(litByConstant(albedo, factor * best), reference).l2, error);
  // Never below 0, and nothing where there is no surface.
  EXPECT_EQ(constantIrradiance(albedo, picture({glm::vec3(-1), glm::vec3(-1)})).x, 0.0);
  EXPECT_EQ(constantIrradiance(Image(2, 1), reference).x, 0.0);
}

TEST(ParetoFront, IsWhatNothingBeatsInBoth) {
  const double nan = std::nan("");
  const std::vector<CostAndError> points{{1, 9}, {2, 5}, {2, 6}, {3, 5}, {4, 1}, {9, 1}, {nan, 0}, {0, nan}, {4, 1}};
  EXPECT_EQ(paretoFront(points), (std::vector<bool>{true, true, false, false, true, false, false, false, false}));
  EXPECT_TRUE(paretoFront({}).empty());
}

TEST(LogLogSlope, OfAPowerLawIsItsExponent) {
  std::vector<double> x, y;
  for (double v : {1.0, 4.0, 16.0, 64.0}) x.push_back(v), y.push_back(3.0 / std::sqrt(v));
  EXPECT_NEAR(logLogSlope(x, y).slope, -0.5, 1e-12);
  EXPECT_NEAR(logLogSlope(x, y).error, 0.0, 1e-9);
  EXPECT_TRUE(std::isnan(logLogSlope(std::vector{2.0, 2.0}, std::vector{1.0, 3.0}).slope));
}

// Residuals of (0,0), (1,1), (2,0) about their mean line y = 1/3: -1/3, 2/3, -1/3; error sqrt((6/9) / 1 / 2).
TEST(LogLogSlope, SaysHowUncertainItIs) {
  const double e = std::exp(1.0);
  const Slope s = logLogSlope(std::vector{1.0, e, e * e}, std::vector{1.0, e, 1.0});
  EXPECT_NEAR(s.slope, 0.0, 1e-12);
  EXPECT_NEAR(s.error, std::sqrt(6.0 / 9.0 / 2.0), 1e-12);
}

// What NVIDIA's program prints for its own pair of pictures: exposures from -12.5423 to 0.9427 stops are 14
// [Andersson2021, README of the program]. A reference of that largest and median luminance gets the same ones.
TEST(Flip, ThePublishedExposuresAreFourteen) {
  // Radiance that ACES maps to 0.85: 1.7047 by hand, the larger root of 0.4445 x^2 - 0.4715 x - 0.119, over 0.6.
  const double bright = (0.4715 + std::sqrt(0.4715 * 0.4715 + 4.0 * 0.4445 * 0.119)) / (2.0 * 0.4445) / 0.6;
  const auto grey = [&](double stops) { return glm::vec3(static_cast<float>(bright * std::exp2(-stops))); };
  const FlipExposures e = flipExposures(picture({grey(0.9427), grey(0.9427), grey(0.9427), grey(-12.5423)}));
  EXPECT_NEAR(e.start, -12.5423, 1e-4);
  EXPECT_NEAR(e.stop, 0.9427, 1e-4);
  EXPECT_EQ(e.count, 14);
}

TEST(HeatMap, ScaleShowsMostOfTheError) {
  Image a(10, 10), b(10, 10);
  EXPECT_EQ(heatMapScale(a, b), 0.0);
  for (glm::vec3& p : a.pixels) p.x = 0.3f;
  EXPECT_NEAR(heatMapScale(a, b), 0.5, 1e-12);
  for (glm::vec3& p : a.pixels) p.x = 0.5f;
  EXPECT_NEAR(heatMapScale(a, b), 0.5, 1e-12);
}

TEST(HeatMap, ColoursSayHowMuchAndWhichWay) {
  const Image reference = picture({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}}),
              image = picture({{1, 1, 1}, {3, 3, 3}, {0, 0, 0}, {std::nanf(""), 0, 0}});
  const Bitmap absolute = heatMap(image, reference, HeatMap::absolute, 1.0),
               sign = heatMap(image, reference, HeatMap::signedLuminance, 1.0);
  const auto at = [](const Bitmap& b, int x) {
    return std::array<int, 3>{b.rgba[4 * static_cast<std::size_t>(x)], b.rgba[4 * static_cast<std::size_t>(x) + 1],
                              b.rgba[4 * static_cast<std::size_t>(x) + 2]};
  };
  EXPECT_EQ(at(absolute, 0), (std::array{0, 0, 0}));
  EXPECT_EQ(at(absolute, 1), (std::array{255, 255, 255}));
  EXPECT_EQ(at(sign, 0), (std::array{247, 247, 247}));
  EXPECT_GT(at(sign, 1)[0], at(sign, 1)[2]);  // too bright: red
  EXPECT_GT(at(sign, 2)[2], at(sign, 2)[0]);  // too dark: blue
  EXPECT_EQ(at(absolute, 3), (std::array{0, 255, 0}));
}

// ---- FLIP: uniform pictures are not changed by filters, have no features, and so leave the colour metric alone ----

double flipOfUniform(glm::vec3 a, glm::vec3 b) { return flipLdr(Image(3, 3, a), Image(3, 3, b), 10.0).mean; }

TEST(Flip, EqualPicturesDoNotDiffer) { EXPECT_NEAR(flipOfUniform(glm::vec3(0.3f), glm::vec3(0.3f)), 0.0, 1e-9); }

TEST(Flip, GreenAgainstBlueIsTheLargestOfAll) { EXPECT_NEAR(flipOfUniform({0, 1, 0}, {0, 0, 1}), 1.0, 1e-9); }

// Black and white: |dL*| = 100, 100^0.7 = 25.11886. Green (L* 87.7362, a* -86.1787, b* 83.1826) and blue
// (32.2982, 79.1936, -107.8586), a* and b* times L*/100: 55.4380 + hypot(-75.6099 - 25.5781, 72.9812 + 34.8364) =
// 203.3017, ^0.7 = 41.2761. Above 0.4 of it, so 0.95 + 0.05 (25.11886 - 16.51044) / (0.6 * 41.2761) = 0.96738.
TEST(Flip, BlackAgainstWhite) { EXPECT_NEAR(flipOfUniform(glm::vec3(0.0f), glm::vec3(1.0f)), 0.96738, 2e-5); }

// Grey 0.2 and 0.25, L* = 116 cbrt(Y) - 16: 51.8372 and 57.0754; 5.2382^0.7 = 3.18734, times 0.95 / 16.51044 = 0.18340.
TEST(Flip, TwoGreysDifferAsPublished) { EXPECT_NEAR(flipOfUniform(glm::vec3(0.25f), glm::vec3(0.2f)), 0.18340, 2e-5); }

// A lattice of colours with an edge and a spot against one with the edge elsewhere, a tint and no spot. The means are
// those of tests/support/flip.py, which has whole two-dimensional kernels where this one's are separated, and luminance
// and colours of its own.
TEST(Flip, IsWhatWholeKernelsGive) {
  constexpr int kWidth = 16, kHeight = 12;
  Image reference(kWidth, kHeight), image = reference;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      const double red = 0.1 + 0.8 * (x % 5) / 4.0, step = 0.7 * (y % 4) / 3.0;
      reference.at(x, y) =
          glm::vec3(glm::dvec3(red, 0.9 - step, 0.2 + 0.5 * (x >= 9) + (x == 4 && y == 5 ? 0.3 : 0.0)));
      image.at(x, y) = glm::vec3(glm::dvec3(red, 0.85 - step, 0.25 + 0.5 * (x >= 11)));
    }
  const Flip ldr = flipLdr(image, reference);
  EXPECT_NEAR(ldr.mean, 0.2560647, 1e-6);
  EXPECT_NEAR(ldr.map[5 * kWidth + 4], 0.2660021, 2e-6);
  for (Image* picture : {&image, &reference})
    for (glm::vec3& p : picture->pixels) p = 40.0f * p * p;
  EXPECT_NEAR(flipHdr(image, reference).mean, 0.3624176, 2e-6);
}

// An edge that is only in one picture counts more than its colour alone: the exponent falls below 1.
TEST(Flip, FeaturesRaiseTheDifference) {
  Image flat(40, 40, glm::vec3(0.5f)), line = flat;
  for (int y = 0; y < 40; ++y) line.at(20, y) = glm::vec3(0.6f);
  const Flip flip = flipLdr(line, flat, 67.0);
  const float beside = flip.map[20 * 40 + 20], far = flip.map[20 * 40 + 2];
  EXPECT_GT(beside, 0.1f);
  EXPECT_LT(far, 0.02f);
}

TEST(Flip, ExposuresFollowTheReference) {
  // The curve reaches 0.85 at radiance 2.26835 / 0.6...: brightest pixel 2^-3 of the median's exposure.
  const FlipExposures e = flipExposures(picture({{1, 1, 1}, {1, 1, 1}, {8, 8, 8}}));
  EXPECT_NEAR(e.stop - e.start, 3.0, 1e-6);
  EXPECT_EQ(e.count, 3);
  const double x = 0.6 * std::exp2(e.stop);
  EXPECT_NEAR(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.85, 1e-6);
}

TEST(Flip, HdrSeesDarkAndBrightDifferences) {
  Image reference(16, 16, glm::vec3(0.01f));
  for (int x = 9; x < 16; ++x)  // the median is dark
    for (int y = 0; y < 16; ++y) reference.at(x, y) = glm::vec3(100.0f);
  Image dark = reference, bright = reference;
  for (int y = 0; y < 16; ++y) dark.at(1, y) *= 3.0f, bright.at(14, y) *= 0.3f;
  EXPECT_GT(flipHdr(dark, reference, 10.0).mean, 0.01);
  EXPECT_GT(flipHdr(bright, reference, 10.0).mean, 0.01);
  EXPECT_EQ(flipHdr(reference, reference, 10.0).mean, 0.0);
}

}  // namespace
