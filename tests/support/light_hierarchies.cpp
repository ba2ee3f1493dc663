#include "support/light_hierarchies.hpp"

#include <glm/gtc/packing.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>

namespace lucerna::test {

std::vector<LocalLamp> mixedLamps(std::size_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  std::vector<LocalLamp> lamps(count);
  for (std::size_t i = 0; i < count; ++i) {
    LocalLamp& lamp = lamps[i];
    const glm::dvec3 place(20.0 * unit(random), 3.0 * unit(random), 20.0 * unit(random)), size(0.3 * unit(random));
    lamp.min = place;
    lamp.max = place + size;
    lamp.axis = glm::normalize(glm::dvec3(unit(random), unit(random), unit(random)) - 0.5);
    lamp.axisAngle = i % 3 == 0 ? kPi : i % 3 == 1 ? 0.6 : 0.0;
    lamp.emissionAngle = i % 3 == 2 ? 0.5 * kPi : 0.0;
    lamp.isTwoSided = i % 3 == 2;
    lamp.intensity = 0.1 + unit(random);
    lamp.light = static_cast<std::uint32_t>(5 + i);
  }
  return lamps;
}

HierarchyNode nodeAt(const LightHierarchy& hierarchy, std::uint32_t pair, int sibling) {
  const glm::uvec4
      *ball = &hierarchy.texels[hierarchy.firstPair() + 4 * std::size_t{pair} + 2 * static_cast<std::size_t>(sibling)],
      *words = ball + 1;
  const auto number = [](std::uint32_t word) { return double{std::bit_cast<float>(word)}; };
  HierarchyNode node;
  node.centre = {number(ball->x), number(ball->y), number(ball->z)};
  node.radius = number(ball->w);
  node.intensity = number(words->x);
  const glm::dvec2 net(glm::unpackSnorm2x16(words->y));
  node.axis = {net, 1.0 - std::abs(net.x) - std::abs(net.y)};
  if (node.axis.z < 0.0)  // the corners of the square are folded down
    node.axis = {(1.0 - std::abs(net.y)) * (net.x < 0.0 ? -1.0 : 1.0),
                 (1.0 - std::abs(net.x)) * (net.y < 0.0 ? -1.0 : 1.0), node.axis.z};
  node.axis = glm::normalize(node.axis);
  const glm::dvec2 cosines(glm::unpackHalf2x16(words->z));
  node.axisAngle = std::acos(std::clamp(cosines.x, -1.0, 1.0));
  node.emissionAngle = std::acos(std::clamp(cosines.y, -1.0, 1.0));
  node.isLeaf = (words->w & LightHierarchy::kLeaf) != 0;
  node.isTwoSided = (words->w & LightHierarchy::kTwoSided) != 0;
  node.link = words->w & 0x3fffffffu;
  return node;
}

namespace {

int depthBelow(const LightHierarchy& hierarchy, std::uint32_t pair) {
  int depth = 0;
  for (int k = 0; k < 2; ++k) {
    const HierarchyNode node = nodeAt(hierarchy, pair, k);
    if (!node.isLeaf) depth = std::max(depth, 1 + depthBelow(hierarchy, k == 0 ? pair + 1 : node.link));
  }
  return depth;
}

double importance(const HierarchyNode& node, const glm::dvec3& position, const glm::dvec3& normal) {
  const glm::dvec3 to = node.centre - position;
  const double distance = glm::length(to), seen = distance > node.radius ? std::asin(node.radius / distance) : kPi;
  const auto bounded = [](double cosine) { return 0.01 + 0.99 * std::max(cosine, 0.0); };
  double away = std::acos(std::clamp(-glm::dot(node.axis, to) / distance, -1.0, 1.0));
  if (node.isTwoSided) away = std::min(away, kPi - away);
  const double beyond = std::max(std::max(away - node.axisAngle, 0.0) - seen, 0.0);
  double result = node.intensity / std::pow(std::max(distance, node.radius), 2.0) *
                  bounded(beyond <= node.emissionAngle + 1e-9 ? std::cos(beyond) : 0.0);
  if (normal != glm::dvec3(0.0)) {
    const double slant = std::acos(std::clamp(glm::dot(normal, to) / distance, -1.0, 1.0));
    result *= bounded(std::cos(std::max(slant - seen, 0.0)));
  }
  return result;
}

void descend(const LightHierarchy& hierarchy, std::uint32_t pair, const glm::dvec3& position, const glm::dvec3& normal,
             double probability, std::vector<double>& result) {
  const HierarchyNode nodes[2] = {nodeAt(hierarchy, pair, 0), nodeAt(hierarchy, pair, 1)};
  const double first = importance(nodes[0], position, normal), second = importance(nodes[1], position, normal);
  for (int k = 0; k < 2; ++k) {
    const double share = probability * (k == 0 ? first : second) / (first + second);
    if (nodes[k].isLeaf) result[nodes[0].link - (k == 0 ? 1 : 0)] = share;
    else descend(hierarchy, k == 0 ? pair + 1 : nodes[1].link, position, normal, share, result);
  }
}

}  // namespace

int depthOf(const LightHierarchy& hierarchy) { return depthBelow(hierarchy, 0); }

std::vector<double> probabilities(const LightHierarchy& hierarchy, const glm::dvec3& position,
                                  const glm::dvec3& normal) {
  std::vector<double> result(hierarchy.lights.size(), 1.0);
  if (result.size() > 1) descend(hierarchy, 0, position, normal, 1.0, result);
  return result;
}

}  // namespace lucerna::test
