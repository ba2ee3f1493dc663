#include "inspect.hpp"

#include "base/error.hpp"

#include <nlohmann/json.hpp>

#include <cstdio>

namespace lucerna::demo {

namespace {

nlohmann::ordered_json vectorToJson(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

nlohmann::ordered_json shareToJson(const PixelInspection& answer, const PixelShare& share) {
  nlohmann::ordered_json json = {{"group", share.group},
                                 {"name", share.name},
                                 {"share", answer.shareOf(share.radiance)},
                                 {"radiance", vectorToJson(share.radiance)}};
  if (share.count > 1) json["count"] = share.count;
  if (share.weight) json["weight"] = *share.weight;
  if (share.lobe)
    for (const glm::vec4& c : *share.lobe) json["lobe"].push_back({c.x, c.y, c.z, c.w});
  for (const glm::dvec3& place : share.places) json["places"].push_back(vectorToJson(place));
  return json;
}

}  // namespace

nlohmann::ordered_json toJson(const PixelInspection& answer) {
  nlohmann::ordered_json json;
  json["pixel"] = {answer.pixel.x, answer.pixel.y};
  json["technique"] = answer.technique;
  json["radiance"] = vectorToJson(answer.radiance);
  json["sum"] = vectorToJson(answer.sum());
  if (answer.samples > 0) {
    json["samples"] = answer.samples;
    json["standard_error"] = vectorToJson(answer.standardError);
  }
  if (answer.surface)
    json["surface"] = {{"position", vectorToJson(answer.surface->position)},
                       {"normal", vectorToJson(answer.surface->normal)},
                       {"albedo", vectorToJson(answer.surface->albedo)}};
  json["groups"] = nlohmann::ordered_json::array();
  for (const auto& [name, radiance] : answer.groups())
    json["groups"].push_back(
        {{"group", name}, {"share", answer.shareOf(radiance)}, {"radiance", vectorToJson(radiance)}});
  json["shares"] = nlohmann::ordered_json::array();
  for (const PixelShare& share : answer.shares) json["shares"].push_back(shareToJson(answer, share));
  return json;
}

glm::ivec2 parsePixel(const std::string& text, glm::ivec2 size) {
  glm::ivec2 pixel(-1);
  char rest = 0;
  if (std::sscanf(text.c_str(), "%d,%d%c", &pixel.x, &pixel.y, &rest) != 2 || pixel.x < 0 || pixel.y < 0 ||
      pixel.x >= size.x || pixel.y >= size.y)
    throwBadInput("--inspect {}: expected X,Y, a pixel of {}x{}, from 0,0 at the top left", text, size.x, size.y);
  return pixel;
}

}  // namespace lucerna::demo
