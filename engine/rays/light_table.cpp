#include "rays/light_table.hpp"

#include "base/angles.hpp"
#include "base/error.hpp"
#include "scene/texture_mean.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

namespace lucerna {

namespace {

double luminance(const glm::dvec3& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }
/// Sampling weight of a light: luminance, but above 0 for a light of any colour.
double worth(const glm::dvec3& c) { return 0.5 * luminance(c) + 0.5 * std::max({c.x, c.y, c.z}); }

/// Solid angle of a texel in row y.
double texelSolidAngle(const Image& picture, int y) {
  return 2.0 * kPi / picture.width * (std::cos(kPi * y / picture.height) - std::cos(kPi * (y + 1) / picture.height));
}

}  // namespace

AliasTable aliasTable(const std::vector<double>& weights) {
  double sum = 0.0;
  for (const double w : weights) sum += w;
  CHECK(std::isfinite(sum) && sum > 0.0, "{} weights with sum {}", weights.size(), sum);
  const std::size_t n = weights.size();
  AliasTable table{std::vector<float>(n, 1.0f), std::vector<std::uint32_t>(n), std::vector<double>(n)};
  std::vector<double> share(n);  // mean 1
  std::vector<std::uint32_t> small, large;
  for (std::size_t i = 0; i < n; ++i) {
    table.alias[i] = static_cast<std::uint32_t>(i);
    table.probability[i] = weights[i] / sum;
    share[i] = table.probability[i] * static_cast<double>(n);
    (share[i] < 1.0 ? small : large).push_back(static_cast<std::uint32_t>(i));
  }
  while (!small.empty() && !large.empty()) {
    const std::uint32_t s = small.back(), l = large.back();
    small.pop_back();
    table.threshold[s] = static_cast<float>(share[s]);
    table.alias[s] = l;
    share[l] -= 1.0 - share[s];
    if (share[l] < 1.0) {
      large.pop_back();
      small.push_back(l);
    }
  }
  // Entries that rounding has left in `small` have a share of 1 up to rounding, unless their weight is 0 and they must
  // never be chosen.
  for (const std::uint32_t s : small)
    if (weights[s] == 0.0) {
      table.threshold[s] = 0.0f;
      table.alias[s] = static_cast<std::uint32_t>(std::max_element(weights.begin(), weights.end()) - weights.begin());
    }
  return table;
}

LightTable lightTable(const Scene& scene, const glm::dvec3& origin, bool sunApart) {
  LightTable table;
  const auto place = [&](const glm::dvec3& p) { return glm::vec3(p - origin); };
  std::vector<double> powers;  // of each light
  const double radius = scene.bounds.empty() ? 1.0 : std::max(0.5 * glm::length(scene.main().extent()), 1e-300);
  const double disc = kPi * radius * radius;
  const auto add = [&](const shared::PathLight& light, double power) {
    if (!(power > 0.0)) return false;
    table.lights.push_back(light);
    powers.push_back(power);
    return true;
  };
  const auto addLamp = [&](const shared::PathLight& light, double power, LocalLamp lamp) {
    lamp.light = static_cast<std::uint32_t>(table.lights.size());
    if (!add(light, power)) return false;
    table.lamps.push_back(lamp);
    return true;
  };
  const auto ball = [](const glm::vec3& centre, double size) {
    return LocalLamp{glm::dvec3(centre) - size, glm::dvec3(centre) + size};
  };

  // Sun and lamps.
  if (scene.sun) {
    shared::PathLight light{};
    light.kind = PATH_LIGHT_SUN;
    light.b = glm::vec3(scene.sun->direction);
    light.c = scene.sun->irradiance;
    light.size = sunLessCosine(*scene.sun);
    add(light, worth(light.c) * disc);
  }
  for (const SpotLight& spot : scene.spots) {
    shared::PathLight light{};
    light.kind = PATH_LIGHT_SPOT;
    light.a = place(spot.position);
    light.b = glm::vec3(spot.direction);
    light.c = spot.intensity;
    light.size = static_cast<float>(spot.radius);
    light.p = std::bit_cast<std::uint32_t>(static_cast<float>(std::cos(spot.innerAngle)));
    light.q = std::bit_cast<std::uint32_t>(static_cast<float>(std::cos(spot.outerAngle)));
    LocalLamp lamp = ball(light.a, spot.radius);
    lamp.axis = spot.direction;
    lamp.axisAngle = spot.outerAngle;
    lamp.intensity = worth(light.c);
    addLamp(light, lamp.intensity * 2.0 * kPi * (1.0 - 0.5 * (std::cos(spot.innerAngle) + std::cos(spot.outerAngle))),
            lamp);
  }
  for (const PointLight& point : scene.points) {
    shared::PathLight light{};
    light.kind = PATH_LIGHT_POINT;
    light.a = place(point.position);
    light.c = point.intensity;
    light.size = static_cast<float>(point.radius);
    LocalLamp lamp = ball(light.a, point.radius);
    lamp.axisAngle = kPi;
    lamp.intensity = worth(light.c);
    addLamp(light, lamp.intensity * 4.0 * kPi, lamp);
  }
  // Emissive triangles.
  const std::size_t lamps = table.lights.size();
  std::vector<double> areas;
  for (const Mesh& mesh : scene.meshes) {
    const auto m = static_cast<std::size_t>(mesh.material);
    const Material& material = scene.materials[m];
    if (!(worth(material.emission) > 0.0)) continue;
    for (std::uint32_t i = mesh.firstIndex; i < mesh.firstIndex + mesh.indexCount; i += 3) {
      const auto corner = [&](std::uint32_t k) { return glm::dvec3(scene.vertices[scene.indices[i + k]].position); };
      const glm::dvec3 a = corner(0), ab = corner(1) - a, ac = corner(2) - a;
      const double area = 0.5 * glm::length(glm::cross(ab, ac));
      if (!(area > 0.0) || !std::isfinite(area)) continue;
      double brightness = worth(material.emission);
      if (material.emissionTexture >= 0) {
        // Weighted by the mean over the triangle plus a share of the picture's own mean: the lookups here may have
        // missed a bright spot.
        const auto uv = [&](std::uint32_t k) { return scene.vertices[scene.indices[i + k]].texCoord; };
        const Texture& texture = scene.textures[static_cast<std::size_t>(material.emissionTexture)];
        brightness = 0.9 * worth(glm::dvec3(material.emissionScale) * meanTexture(texture, {uv(0), uv(1), uv(2)})) +
                     0.1 * brightness;
      }
      shared::PathLight light{};
      light.kind = PATH_LIGHT_TRIANGLE;
      light.a = place(a);
      light.b = glm::vec3(ab);
      light.c = glm::vec3(ac);
      light.p = i / 3;
      light.q = static_cast<std::uint32_t>(mesh.material);
      const glm::dvec3 p(light.a), q = p + glm::dvec3(light.b), r = p + glm::dvec3(light.c);
      const LocalLamp lamp{.min = glm::min(p, glm::min(q, r)),
                           .max = glm::max(p, glm::max(q, r)),
                           .axis = glm::cross(ab, ac) / (2.0 * area),
                           .emissionAngle = 0.5 * kPi,
                           .isTwoSided = true,
                           .intensity = brightness * area};
      if (addLamp(light, lamp.intensity * 2.0 * kPi, lamp)) areas.push_back(area);  // both sides emit
    }
  }
  // The environment, last.
  const std::size_t triangles = table.lights.size() - lamps;
  if (scene.environment && scene.environment->picture) {
    shared::PathLight light{};
    light.kind = PATH_LIGHT_ENVIRONMENT;
    add(light,
        worth(glm::dvec3(scene.environment->radiance) * meanRadiance(*scene.environment->picture)) * 4.0 * kPi * disc);
  }
  if (table.lights.empty()) return table;
  const bool environment = table.lights.back().kind == PATH_LIGHT_ENVIRONMENT;

  // Under a picture of a sky the samples are better both drawn: one of each has 1.2 times the squared error in the
  // atrium, where shade that the cell of a surface does not know leaves the sky to few paths.
  table.sunApart = sunApart && table.lights.size() > 1 && table.lights.front().kind == PATH_LIGHT_SUN && !environment;
  const std::size_t first = table.sunApart ? 1 : 0;
  if (table.sunApart) table.lights.front().probability = 1.0f;

  // Picked half by power, half evenly; for the even half all triangles together count as one light.
  double sum = 0.0, triangleSum = 0.0;
  for (std::size_t i = first; i < powers.size(); ++i) {
    sum += powers[i];
    if (i >= lamps && i < lamps + triangles) triangleSum += powers[i];
  }
  const double parties = static_cast<double>(lamps - first) + (triangles > 0 ? 1.0 : 0.0) + (environment ? 1.0 : 0.0);
  std::vector<double> weights;
  for (std::size_t i = first; i < powers.size(); ++i) {
    const bool isTriangle = i >= lamps && i < lamps + triangles;
    weights.push_back(0.5 * powers[i] / sum + 0.5 / parties * (isTriangle ? powers[i] / triangleSum : 1.0));
  }
  const AliasTable picks = aliasTable(weights);
  for (std::size_t i = first; i < powers.size(); ++i) {
    shared::PathLight& light = table.lights[i];
    light.threshold = picks.threshold[i - first];
    light.alias = static_cast<std::uint32_t>(first) + picks.alias[i - first];
    light.probability = static_cast<float>(picks.probability[i - first]);
    if (light.kind != PATH_LIGHT_SUN && light.kind != PATH_LIGHT_ENVIRONMENT)
      table.lampPick += picks.probability[i - first];
    if (light.kind == PATH_LIGHT_TRIANGLE) {
      table.pickDensity.resize(scene.triangleCount());
      table.pickDensity[light.p] = static_cast<float>(picks.probability[i - first] / areas[i - lamps]);
    }
  }
  for (LocalLamp& lamp : table.lamps)
    if (const shared::PathLight& light = table.lights[lamp.light]; light.kind == PATH_LIGHT_TRIANGLE)
      lamp.density = table.pickDensity[light.p];
  if (environment) table.environmentPick = picks.probability.back();
  return table;
}

glm::dvec3 meanRadiance(const Image& picture) {
  glm::dvec3 sum(0.0);
  for (int y = 0; y < picture.height; ++y) {
    glm::dvec3 row(0.0);
    for (int x = 0; x < picture.width; ++x) row += glm::dvec3(picture.at(x, y));
    sum += row * texelSolidAngle(picture, y);
  }
  return sum / (4.0 * kPi);
}

EnvironmentTable environmentTable(const Image& picture) {
  const auto width = static_cast<std::size_t>(picture.width), height = static_cast<std::size_t>(picture.height);
  // A 32-bit number is below the threshold with the entry's probability. At probability 1 any number will do, since the
  // alias is the entry itself.
  const auto wordOf = [](float threshold) {
    return static_cast<std::uint32_t>(std::min(static_cast<double>(threshold) * 4294967296.0, 4294967295.0));
  };
  EnvironmentTable table;
  table.texels.resize(width * height);
  std::vector<double> weights(width), ofRows(height);
  for (std::size_t y = 0; y < height; ++y) {
    const int row = static_cast<int>(y);
    for (std::size_t x = 0; x < width; ++x) weights[x] = worth(glm::dvec3(picture.at(static_cast<int>(x), row)));
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    ofRows[y] = sum * texelSolidAngle(picture, row);
    if (!(sum > 0.0)) continue;  // never sampled
    const AliasTable picks = aliasTable(weights);
    for (std::size_t x = 0; x < width; ++x)
      table.texels[y * width + x] = glm::uvec4(wordOf(picks.threshold[x]), picks.alias[x], 0u, 0u);
  }
  const double all = std::accumulate(ofRows.begin(), ofRows.end(), 0.0);
  const AliasTable picks = aliasTable(ofRows);
  for (std::size_t y = 0; y < height; ++y) {
    table.rows.emplace_back(wordOf(picks.threshold[y]), picks.alias[y], 0u, 0u);
    for (std::size_t x = 0; x < width; ++x)  // the solid angle cancels
      table.texels[y * width + x].z = std::bit_cast<std::uint32_t>(
          static_cast<float>(worth(glm::dvec3(picture.at(static_cast<int>(x), static_cast<int>(y)))) / all));
  }
  return table;
}

}  // namespace lucerna
