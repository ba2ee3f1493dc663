#include "shared/figure.hpp"

#include "base/error.hpp"
#include "shared/html.hpp"

#include <fmt/format.h>
#include <glm/gtc/packing.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <utility>
#include <vector>

namespace lucerna::demo::bench {

namespace {

static_assert(std::endian::native == std::endian::little, "planes are little-endian");

glm::ivec2 shrunkSize(const Image& image, int block) {
  return {(image.width + block - 1) / block, (image.height + block - 1) / block};
}

/// Reduces each block of block x block pixels, cut off at the edge, to one: f(sum of pixels, their number).
template <typename Of>
std::vector<glm::dvec3> shrunk(const Image& image, int block, bool squares, Of of) {
  const glm::ivec2 size = shrunkSize(image, block);
  std::vector<glm::dvec3> result;
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) {
      glm::dvec3 sum(0.0);
      double count = 0.0;
      for (int v = y * block; v < std::min((y + 1) * block, image.height); ++v)
        for (int u = x * block; u < std::min((x + 1) * block, image.width); ++u, count += 1.0) {
          const glm::dvec3 p(image.at(u, v));
          sum += squares ? p * p : p;
        }
      result.push_back(of(sum, count));
    }
  return result;
}
std::vector<glm::dvec3> means(const Image& image, int block) {
  return shrunk(image, block, false, [](const glm::dvec3& sum, double n) { return sum / n; });
}
/// Standard errors of block means over independent pixels.
std::vector<glm::dvec3> standardErrors(const Image& image, int block) {
  return shrunk(image, block, true, [](const glm::dvec3& sum, double n) { return glm::sqrt(sum) / n; });
}

std::string floats(const std::vector<glm::dvec3>& values) {
  std::vector<float> flat;
  for (const glm::dvec3& v : values)
    for (int c = 0; c < 3; ++c) flat.push_back(static_cast<float>(v[c]));
  return base64({reinterpret_cast<const std::uint8_t*>(flat.data()), flat.size() * sizeof(float)});
}

/// The power of two that scales the largest value to below 2^15: halves end at 65504, and lose digits below 2^-14.
double halfScale(const std::vector<glm::dvec3>& values) {
  double largest = 0.0;
  for (const glm::dvec3& v : values)
    for (int c = 0; c < 3; ++c)
      if (std::isfinite(v[c])) largest = std::max(largest, std::abs(v[c]));
  return largest > 0.0 ? std::exp2(15.0 - std::ceil(std::log2(largest))) : 1.0;
}
std::string halves(const std::vector<glm::dvec3>& values, double scale) {
  std::vector<std::uint16_t> flat;
  for (const glm::dvec3& v : values)
    for (int c = 0; c < 3; ++c) flat.push_back(glm::packHalf1x16(static_cast<float>(scale * v[c])));
  return base64({reinterpret_cast<const std::uint8_t*>(flat.data()), flat.size() * sizeof(std::uint16_t)});
}

std::string bytesOf(const Bitmap& map, int block) {
  Image grey(map.width, map.height);
  for (std::size_t i = 0; i < grey.pixels.size(); ++i) grey.pixels[i] = glm::vec3(map.rgba[4 * i]);
  std::vector<std::uint8_t> flat;
  for (const glm::dvec3& v : means(grey, block)) flat.push_back(static_cast<std::uint8_t>(std::lround(v.x)));
  return base64(flat);
}

std::string plane(const std::string& name, const std::string& data) {
  return fmt::format("<script type=\"text/plain\" data-plane=\"{}\">{}</script>\n", name, data);
}

/// JSON between script tags: must not contain "</", which would end them early.
std::string scriptJson(const nlohmann::ordered_json& json) {
  std::string text = json.dump();
  for (std::size_t at = 0; (at = text.find("</", at)) != std::string::npos; at += 3) text.replace(at, 2, "<\\/");
  return text;
}

/// Base64 bytes of a picture or a reference.
std::size_t cost(glm::ivec2 size, std::size_t bytesOfPixel) {
  return static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) * bytesOfPixel * 4 / 3;
}

}  // namespace

std::string figureHtml(const Figure& figure, std::size_t bytes) {
  CHECK(!figure.references.empty(), "no reference");
  const Image& first = *figure.references.front().mean;
  // Choose what fits: all pictures; else the first choice with the others shrunk; else all shrunk.
  const auto total = [&](int block, int ofOthers) {
    std::size_t sum = figure.references.size() * cost(shrunkSize(first, block), 12 + 6);
    for (const FigurePicture& p : figure.pictures)
      sum += cost(shrunkSize(first, p.isFirstChoice ? block : block * ofOthers),
                  6 + (p.flip.rgba.empty() ? 0u : 1u) + (p.standardError ? 6u : 0u));
    return sum;
  };
  constexpr int kMostOfOthers = 4;
  int block = 1, ofOthers = 1;
  while (total(block, ofOthers) > bytes && block < std::max(first.width, first.height))
    if (++ofOthers > kMostOfOthers) ++block, ofOthers = 1;

  nlohmann::ordered_json facts = figure.facts;
  const glm::ivec2 size = shrunkSize(first, block);
  facts["picture_size"] = {size.x, size.y};
  facts["block"] = block;
  std::string planes;
  facts["references"] = nlohmann::ordered_json::array();
  for (const FigureReference& reference : figure.references) {
    const std::string key = fmt::format("r{}", facts["references"].size());
    planes += plane(key, floats(means(*reference.mean, block)));
    nlohmann::ordered_json json{{"name", reference.name}, {"error_scale", nullptr}};
    if (reference.standardError) {
      const std::vector<glm::dvec3> errors = standardErrors(*reference.standardError, block);
      json["error_scale"] = halfScale(errors);
      planes += plane(key + "e", halves(errors, json["error_scale"].get<double>()));
    }
    facts["references"].push_back(std::move(json));
  }
  facts["pictures"] = nlohmann::ordered_json::array();
  std::map<std::pair<std::size_t, int>, std::vector<glm::dvec3>> exactMeans;  // by reference and block
  for (const FigurePicture& p : figure.pictures) {
    const std::string key = fmt::format("p{}", facts["pictures"].size());
    const int within = p.isFirstChoice ? 1 : ofOthers, all = block * within;
    std::vector<glm::dvec3>& exact = exactMeans[{p.reference, all}];
    if (exact.empty()) exact = means(*figure.references.at(p.reference).mean, all);
    std::vector<glm::dvec3> difference = means(*p.picture, all);
    CHECK(difference.size() == exact.size(), "{} and {} pixels", difference.size(), exact.size());
    for (std::size_t i = 0; i < exact.size(); ++i) difference[i] -= exact[i];
    nlohmann::ordered_json json{{"row", p.row},
                                {"reference", p.reference},
                                {"block", within},
                                {"first_choice", p.isFirstChoice},
                                {"scale", halfScale(difference)},
                                {"flip", !p.flip.rgba.empty()},
                                {"error_scale", nullptr}};
    planes += plane(key, halves(difference, json["scale"].get<double>()));
    if (!p.flip.rgba.empty()) planes += plane(key + "f", bytesOf(p.flip, all));
    if (p.standardError) {
      const std::vector<glm::dvec3> errors = standardErrors(*p.standardError, all);
      json["error_scale"] = halfScale(errors);
      planes += plane(key + "e", halves(errors, json["error_scale"].get<double>()));
    }
    facts["pictures"].push_back(std::move(json));
  }
  return "<div class=\"lf\" data-figure>\n<noscript><p>This figure needs a browser that runs scripts; tables and "
         "pictures below do not.</p></noscript>\n"
         "<script type=\"application/json\">" +
         scriptJson(facts) + "</script>\n" + planes + "</div>\n";
}

}  // namespace lucerna::demo::bench
