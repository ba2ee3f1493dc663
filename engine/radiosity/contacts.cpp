#include "radiosity/contacts.hpp"

#include "base/parallel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>
#include <span>

namespace lucerna {

namespace {

/// What touches, and the least length of a contact: a fraction of the scene's largest extent.
constexpr double kTouch = 1e-4;
/// Smaller triangles neither are cut nor cut others, and shorter contacts cut nothing: fractions of the patches'
/// longest edge. The atrium's 128,262 patches become 158,165; 817,171 if all are cut.
constexpr double kLeastTriangle = 0.5, kLeastContact = 0.1;

using Corners = std::array<glm::dvec3, 3>;

glm::dvec3 normalOf(const Corners& c) { return glm::normalize(glm::cross(c[1] - c[0], c[2] - c[0])); }

double longestEdgeOf(const Corners& c) {
  return std::max({glm::distance(c[0], c[1]), glm::distance(c[1], c[2]), glm::distance(c[2], c[0])});
}

bool areNear(const Bounds& a, const Bounds& b, double slack) {
  return glm::all(glm::lessThanEqual(a.min - slack, b.max)) && glm::all(glm::lessThanEqual(b.min - slack, a.max));
}

/// Finds the triangles whose boxes overlap another's: a tree of halves by number.
class BoxTree {
 public:
  explicit BoxTree(const std::vector<Corners>& triangles) : order_(triangles.size()) {
    std::iota(order_.begin(), order_.end(), 0u);
    for (const Corners& corners : triangles) {
      Bounds& box = boxes_.emplace_back();
      for (const glm::dvec3& corner : corners) box.add(corner);
    }
    build(0, order_.size());
  }

  /// Calls `visit` with each triangle near triangle i, other than itself.
  template <class Visit>
  void eachNear(std::uint32_t i, double slack, const Visit& visit) const {
    std::vector<std::uint32_t> open{0};
    while (!open.empty()) {
      const Node& node = nodes_[open.back()];
      open.pop_back();
      if (!areNear(node.box, boxes_[i], slack)) continue;
      if (node.second) open.insert(open.end(), {node.second, node.first});
      else
        for (std::size_t k = node.begin; k < node.end; ++k)
          if (order_[k] != i && areNear(boxes_[order_[k]], boxes_[i], slack)) visit(order_[k]);
    }
  }

 private:
  static constexpr std::size_t kLeaf = 8;
  struct Node {
    Bounds box;
    std::size_t begin, end;  ///< in order_
    std::uint32_t first = 0, second = 0;  ///< nodes; none for leaves
  };

  std::uint32_t build(std::size_t begin, std::size_t end) {
    const auto index = static_cast<std::uint32_t>(nodes_.size());
    Node node{{}, begin, end};
    for (std::size_t k = begin; k < end; ++k) node.box.add(boxes_[order_[k]]);
    nodes_.push_back(node);
    if (end - begin <= kLeaf) return index;
    const glm::dvec3 size = node.box.extent();
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::size_t middle = (begin + end) / 2;
    const auto place = [&](std::uint32_t t) { return boxes_[t].min[axis] + boxes_[t].max[axis]; };
    std::nth_element(order_.begin() + static_cast<std::ptrdiff_t>(begin),
                     order_.begin() + static_cast<std::ptrdiff_t>(middle),
                     order_.begin() + static_cast<std::ptrdiff_t>(end),
                     [&](std::uint32_t a, std::uint32_t b) { return std::pair(place(a), a) < std::pair(place(b), b); });
    const std::uint32_t first = build(begin, middle), second = build(middle, end);
    nodes_[index].first = first;
    nodes_[index].second = second;
    return index;
  }

  std::vector<Bounds> boxes_;
  std::vector<std::uint32_t> order_;
  std::vector<Node> nodes_;
};

/// A line in a triangle's plane along which another triangle stands on it.
struct Contact {
  glm::dvec3 begin, end;
  double size;  ///< longest edge of the other
  double length;  ///< beyond this triangle too
  std::vector<glm::dvec3> standing;  ///< unit directions, across the line, in which the other goes on
};

/// The piece of a line within a triangle that is widened by `slack`, if it is longer than `least`.
std::optional<std::array<glm::dvec3, 2>> within(const Corners& c, const glm::dvec3& normal, const glm::dvec3& begin,
                                                const glm::dvec3& end, double slack, double least) {
  double from = 0.0, to = 1.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 inward = glm::normalize(glm::cross(normal, c[(k + 1) % 3] - c[k]));
    const double atBegin = glm::dot(inward, begin - c[k]) + slack, atEnd = glm::dot(inward, end - c[k]) + slack;
    if (atBegin < 0.0 && atEnd < 0.0) return std::nullopt;
    if (atBegin < 0.0) from = std::max(from, atBegin / (atBegin - atEnd));
    if (atEnd < 0.0) to = std::min(to, atBegin / (atBegin - atEnd));
  }
  if (!((to - from) * glm::distance(begin, end) > least)) return std::nullopt;
  return std::array{glm::mix(begin, end, from), glm::mix(begin, end, to)};
}

/// Where triangle b stands on triangle a or passes through it.
std::optional<Contact> contactOf(const Corners& a, const Corners& b, double touch) {
  const glm::dvec3 normal = normalOf(a);
  std::array<double, 3> height{};
  for (std::size_t k = 0; k < 3; ++k) {
    height[k] = glm::dot(normal, b[k] - a[0]);
    if (std::abs(height[k]) <= touch) height[k] = 0.0;
  }
  std::vector<glm::dvec3> ends;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    if (height[k] == 0.0) ends.push_back(b[k]);
    if (height[k] * height[next] < 0.0) ends.push_back(glm::mix(b[k], b[next], height[k] / (height[k] - height[next])));
  }
  if (ends.size() != 2) return std::nullopt;  // apart, a corner only, or in one plane
  for (glm::dvec3& end : ends) end -= glm::dot(normal, end - a[0]) * normal;
  const auto line = within(a, normal, ends[0], ends[1], touch, touch);
  if (!line) return std::nullopt;
  Contact contact{(*line)[0], (*line)[1], longestEdgeOf(b), glm::distance(ends[0], ends[1]), {}};
  const glm::dvec3 along = glm::normalize(contact.end - contact.begin);
  for (std::size_t k = 0; k < 3; ++k) {
    if (height[k] == 0.0) continue;
    const glm::dvec3 to = b[k] - contact.begin, across = to - glm::dot(to, along) * along;
    contact.standing.push_back(glm::normalize(across));
  }
  return contact;
}

class Cutter {
 public:
  Cutter(RadiosityMesh& mesh, double touch) : mesh_(mesh), touch_(touch), pieces_(mesh.patches.size()) {
    for (std::uint32_t p = 0; p < mesh.patches.size(); ++p) {
      pieces_[p].push_back(p);
      whole_.push_back(p);
      for (std::size_t k = 0; k < 3; ++k) onEdge_[edge(p, k)].insert(p);
    }
  }

  /// Cuts a whole triangle's pieces, so that edges of them run along the contact.
  void cut(std::uint32_t whole, const Contact& contact) {
    const glm::dvec3 along = glm::normalize(contact.end - contact.begin);
    const glm::dvec3 across = glm::cross(mesh_.patches[whole].faceNormal, along);
    std::vector<std::uint32_t>& pieces = pieces_[whole];  // grows meanwhile
    for (std::size_t i = 0; i < pieces.size(); ++i)
      while (const auto crossing = crossingOf(pieces[i], contact, across)) split(pieces[i], *crossing);
    // The cuts run on to the border of a piece; the contact's ends cut them in turn.
    for (const glm::dvec3& end : {contact.begin, contact.end})
      for (std::size_t i = 0; i < pieces.size(); ++i)
        if (const auto inside = insideEdge(pieces[i], contact, across, along, end)) split(pieces[i], *inside);
  }

  /// Enters what stands on the edges along a contact.
  void stand(std::uint32_t whole, const Contact& contact) {
    const glm::dvec3 along = glm::normalize(contact.end - contact.begin);
    const double length = glm::distance(contact.begin, contact.end);
    const auto isOn = [&](std::uint32_t point) {
      const glm::dvec3 to = mesh_.points[point] - contact.begin;
      const double place = glm::dot(to, along);
      return place >= -touch_ && place <= length + touch_ && glm::length(to - place * along) <= 2.0 * touch_;
    };
    for (const std::uint32_t piece : pieces_[whole])
      for (std::size_t k = 0; k < 3; ++k) {
        const MeshEdge at = edge(piece, k);
        if (!isOn(at[0]) || !isOn(at[1])) continue;
        std::vector<glm::dvec3>& directions = mesh_.standing[at];
        directions.insert(directions.end(), contact.standing.begin(), contact.standing.end());
      }
  }

  /// Forgets what stands between no two patches.
  void tidy() {
    std::erase_if(mesh_.standing, [&](const auto& entry) {
      const auto& [edge, directions] = entry;
      const std::set<std::uint32_t>& on = onEdge_.at(edge);
      for (const std::uint32_t a : on)
        for (const std::uint32_t b : on) {
          Patch backA = mesh_.patches[a], backB = mesh_.patches[b];
          backA.faceNormal = -backA.faceNormal;
          backB.faceNormal = -backB.faceNormal;
          if (a < b &&
              (isBetween(directions, mesh_.patches[a], mesh_.patches[b]) || isBetween(directions, backA, backB)))
            return false;
        }
      return true;
    });
  }

  std::vector<std::uint32_t> changed() const { return {changed_.begin(), changed_.end()}; }

 private:
  struct Place {
    std::size_t edge;
    double at;  ///< from 0 to 1 along it
  };

  MeshEdge edge(std::uint32_t p, std::size_t k) const {
    return edgeOf(mesh_.patches[p].point[k], mesh_.patches[p].point[(k + 1) % 3]);
  }

  std::array<double, 3> sidesOf(std::uint32_t piece, const Contact& contact, const glm::dvec3& across) const {
    std::array<double, 3> sides{};
    for (std::size_t k = 0; k < 3; ++k) {
      sides[k] = glm::dot(across, mesh_.points[mesh_.patches[piece].point[k]] - contact.begin);
      if (std::abs(sides[k]) <= touch_) sides[k] = 0.0;
    }
    return sides;
  }

  /// Where the line of a contact that runs through a piece crosses one of its edges.
  std::optional<Place> crossingOf(std::uint32_t piece, const Contact& contact, const glm::dvec3& across) const {
    const std::array<double, 3> sides = sidesOf(piece, contact, across);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      if (sides[k] * sides[next] >= 0.0) continue;
      const Patch& patch = mesh_.patches[piece];
      if (!within(mesh_.corners(patch), patch.faceNormal, contact.begin, contact.end, 0.0, touch_)) return std::nullopt;
      return Place{k, sides[k] / (sides[k] - sides[next])};
    }
    return std::nullopt;
  }

  /// Where the end of a contact lies on an edge that runs along it, away from the edge's ends.
  std::optional<Place> insideEdge(std::uint32_t piece, const Contact& contact, const glm::dvec3& across,
                                  const glm::dvec3& along, const glm::dvec3& end) const {
    const std::array<double, 3> sides = sidesOf(piece, contact, across);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t next = (k + 1) % 3;
      if (sides[k] != 0.0 || sides[next] != 0.0) continue;
      const Patch& patch = mesh_.patches[piece];
      const double from = glm::dot(along, mesh_.points[patch.point[k]] - end),
                   to = glm::dot(along, mesh_.points[patch.point[next]] - end);
      if (std::min(from, to) < -touch_ && std::max(from, to) > touch_) return Place{k, from / (from - to)};
    }
    return std::nullopt;
  }

  /// Cuts an edge, and all patches on it.
  void split(std::uint32_t piece, const Place& place) {
    const Patch& patch = mesh_.patches[piece];
    const std::uint32_t from = patch.point[place.edge], to = patch.point[(place.edge + 1) % 3];
    const auto middle = static_cast<std::uint32_t>(mesh_.points.size());
    mesh_.points.push_back(glm::mix(mesh_.points[from], mesh_.points[to], place.at));
    const std::set<std::uint32_t> patches = std::move(onEdge_.extract(edgeOf(from, to)).mapped());
    if (const auto stood = mesh_.standing.extract(edgeOf(from, to)); !stood.empty())
      for (const std::uint32_t end : {from, to}) mesh_.standing[edgeOf(end, middle)] = stood.mapped();
    for (const std::uint32_t p : patches) {
      const auto added = static_cast<std::uint32_t>(mesh_.patches.size());
      std::size_t k = 0;
      while (edge(p, k) != edgeOf(from, to)) ++k;
      const bool forward = mesh_.patches[p].point[k] == from;
      const auto halves = halvesOf(mesh_.patches[p], k, forward ? place.at : 1.0 - place.at, middle);
      onEdge_[edge(p, (k + 1) % 3)].erase(p);
      mesh_.patches[p] = halves[0];
      mesh_.patches.push_back(halves[1]);
      for (std::size_t e = 0; e < 3; ++e) onEdge_[edge(p, e)].insert(p), onEdge_[edge(added, e)].insert(added);
      whole_.push_back(whole_[p]);
      pieces_[whole_[p]].push_back(added);
      changed_.insert({p, added});
    }
  }

  RadiosityMesh& mesh_;
  double touch_;
  std::vector<std::vector<std::uint32_t>> pieces_;  ///< of each whole triangle
  std::vector<std::uint32_t> whole_;  ///< of each patch
  std::map<MeshEdge, std::set<std::uint32_t>> onEdge_;  ///< patches
  std::set<std::uint32_t> changed_;
};

/// The contacts of each patch, each a whole triangle.
std::vector<std::vector<Contact>> contactsOf(const RadiosityMesh& mesh, double touch,
                                             const std::function<bool(const Patch&, const Patch&)>& between) {
  std::vector<Corners> triangles;
  std::map<MeshEdge, int> patchesOn;
  for (const Patch& patch : mesh.patches) {
    triangles.push_back(mesh.corners(patch));
    for (std::size_t k = 0; k < 3; ++k) ++patchesOn[edgeOf(patch.point[k], patch.point[(k + 1) % 3])];
  }
  // Neighbours in a sheet meet at an edge, too.
  const auto areNeighbours = [&](const Patch& a, const Patch& b) {
    std::vector<std::uint32_t> common;
    for (const std::uint32_t point : a.point)
      if (std::ranges::find(b.point, point) != b.point.end()) common.push_back(point);
    return common.size() == 3 || (common.size() == 2 && patchesOn.at(edgeOf(common[0], common[1])) == 2);
  };
  const BoxTree tree(triangles);
  std::vector<std::vector<Contact>> contacts(triangles.size());
  onAllCores(triangles.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t a = begin; a < end; ++a) {
      std::vector<std::uint32_t> near;
      tree.eachNear(static_cast<std::uint32_t>(a), touch, [&](std::uint32_t b) { near.push_back(b); });
      if (between) {
        std::erase_if(near, [&](std::uint32_t b) { return !between(mesh.patches[a], mesh.patches[b]); });
        std::ranges::sort(near);
      }
      for (const std::uint32_t b : near) {
        if (areNeighbours(mesh.patches[a], mesh.patches[b])) continue;
        if (auto contact = contactOf(triangles[a], triangles[b], touch)) contacts[a].push_back(std::move(*contact));
      }
    }
  });
  return contacts;
}

}  // namespace

bool isBetween(std::span<const glm::dvec3> standing, const Patch& a, const Patch& b) {
  constexpr double kRises = 0.15;  // sine to both; less is a neighbour in a curved sheet
  return std::ranges::any_of(standing, [&](const glm::dvec3& direction) {
    return glm::dot(direction, a.faceNormal) > kRises && glm::dot(direction, b.faceNormal) > kRises;
  });
}

std::vector<std::uint32_t> cutAtContacts(RadiosityMesh& mesh, double longestEdge,
                                         const std::function<bool(const Patch&, const Patch&)>& between) {
  const double touch = kTouch * mesh.extent, least = kLeastTriangle * longestEdge;
  const std::vector<std::vector<Contact>> contacts = contactsOf(mesh, touch, between);
  std::vector<bool> isLarge;
  for (const Patch& patch : mesh.patches) isLarge.push_back(longestEdgeOf(mesh.corners(patch)) > least);
  Cutter cutter(mesh, touch);
  for (std::uint32_t whole = 0; whole < contacts.size(); ++whole)
    for (const Contact& contact : contacts[whole])
      if (isLarge[whole] && contact.size > least && contact.length > kLeastContact * longestEdge)
        cutter.cut(whole, contact);
  for (std::uint32_t whole = 0; whole < contacts.size(); ++whole)
    for (const Contact& contact : contacts[whole]) cutter.stand(whole, contact);
  cutter.tidy();
  return cutter.changed();
}

}  // namespace lucerna
