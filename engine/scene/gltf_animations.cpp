#include "scene/gltf_animations.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>
#include <string_view>
#include <utility>

namespace lucerna {

GltfAnimations::GltfAnimations(const GltfFile& file)
    : moves_(file.parents().size(), false), morphs_(file.parents().size(), false) {
  for (std::size_t a = 0; a < file.count("animations"); ++a) {
    const Value animation = file.at("animations", a);
    if (!animation.json.is_object() || !animation.has("channels") || !animation.at("channels").json.is_array() ||
        !animation.has("samplers") || !animation.at("samplers").json.is_array())
      animation.fail("an object with arrays of channels and samplers");
    const Value channels = animation.at("channels");
    for (std::size_t c = 0; c < channels.json.size(); ++c) addChannel(file, animation, channels.at(c));
  }
  for (const Channel& channel : channels_) {
    (channel.path == Path::weights ? morphs_ : moves_)[channel.node] = true;
    end_ = std::max(end_, channel.curve.times.back());
  }
  for (const Property& property : properties_) end_ = std::max(end_, property.curve.times.back());
  // What hangs on a node moves with it.
  std::vector<bool> known(moves_.size(), false);
  for (std::size_t i = 0; i < moves_.size(); ++i) {
    std::vector<std::size_t> way;
    int at = static_cast<int>(i);
    for (; at >= 0 && !known[static_cast<std::size_t>(at)]; at = file.parents()[static_cast<std::size_t>(at)])
      way.push_back(static_cast<std::size_t>(at));
    bool moved = at >= 0 && moves_[static_cast<std::size_t>(at)];
    for (auto step = way.rbegin(); step != way.rend(); ++step) {
      moves_[*step] = moved = moved || moves_[*step];
      known[*step] = true;
    }
  }
}

namespace {

constexpr std::string_view kPaths[] = {"translation", "rotation", "scale", "weights"};

/// A pointer "/ARRAY/INDEX/NAME" to its index and name; empty if it is none into this array.
std::optional<std::pair<std::size_t, std::string>> memberIn(std::string_view array, const std::string& pointer) {
  const std::string start = fmt::format("/{}/", array);
  if (!pointer.starts_with(start)) return {};
  std::size_t index = 0;
  const char *first = pointer.data() + start.size(), *last = pointer.data() + pointer.size();
  const auto [end, error] = std::from_chars(first, last, index);
  if (error != std::errc() || end == last || *end != '/') return {};
  return std::pair(index, std::string(end + 1, last));
}

/// width: numbers of a value; 0: any. of: whose it is, for messages.
Curve curveOf(const GltfFile& file, const Value& sampler, std::size_t width, const std::string& of) {
  if (!sampler.json.is_object() || !sampler.has("input") || !sampler.has("output"))
    sampler.fail("an object with input and output");
  constexpr std::string_view kTypes[] = {"SCALAR", "SCALAR", "VEC2", "VEC3", "VEC4"};
  const GltfNumbers times = file.numbers(file.indexOf(sampler.at("input"), "accessors"), "SCALAR"),
                    values = file.numbers(file.indexOf(sampler.at("output"), "accessors"), kTypes[width]);
  Curve curve;
  const std::string interpolation = sampler.has("interpolation") ? sampler.at("interpolation").text() : "LINEAR";
  if (interpolation == "STEP") curve.interpolation = Curve::Interpolation::step;
  else if (interpolation == "CUBICSPLINE") curve.interpolation = Curve::Interpolation::tangents;
  else if (interpolation != "LINEAR") sampler.at("interpolation").fail("LINEAR, STEP or CUBICSPLINE");
  for (std::size_t i = 0; i < times.count; ++i) {
    const double time = times.at(i, 0);
    if (!std::isfinite(time) || (i > 0 && !(time > curve.times.back())))
      sampler.at("input").fail("times that are finite and rise");
    curve.times.push_back(time);
  }
  const std::size_t perKey = curve.interpolation == Curve::Interpolation::tangents ? 3 : 1;
  const std::size_t elements = times.count == 0 ? 0 : values.count / (times.count * perKey);
  if (elements == 0 || elements * times.count * perKey != values.count || (width != 0 && elements != 1))
    sampler.at("output").fail(fmt::format("values for {} times of {}, not {}", times.count, of, values.count));
  curve.width = values.width * elements;
  for (std::size_t i = 0; i < values.count; ++i)
    for (std::size_t k = 0; k < values.width; ++k) {
      curve.values.push_back(values.at(i, k));
      if (!std::isfinite(curve.values.back())) sampler.at("output").fail("values that are finite");
    }
  return curve;
}

/// Morph targets of a node's mesh.
std::size_t morphTargetsOf(const GltfFile& file, std::size_t node) {
  const Value of = file.root().at("nodes").at(node);
  if (!of.has("mesh")) return 0;
  const Value mesh = file.root().at("meshes").at(file.indexOf(of.at("mesh"), "meshes"));
  if (!mesh.has("primitives") || !mesh.at("primitives").json.is_array() || mesh.at("primitives").json.empty()) return 0;
  const Value first = mesh.at("primitives").at(std::size_t{0});
  return first.json.is_object() && first.has("targets") ? first.at("targets").json.size() : 0;
}

void checkWeights(const GltfFile& file, std::size_t node, const Curve& curve, const Value& output) {
  const std::size_t targets = morphTargetsOf(file, node);
  if (targets > 0 && curve.width != targets)
    output.fail(fmt::format("a weight at each time for each of {} morph targets of node {}, not {}", targets, node,
                            curve.width));
}

void checkRotations(const Curve& curve, const Value& output) {
  const bool hasTangents = curve.interpolation == Curve::Interpolation::tangents;
  for (std::size_t key = 0; key < curve.times.size(); ++key) {
    const double* quaternion = &curve.values[4 * (hasTangents ? 3 * key + 1 : key)];
    if (std::all_of(quaternion, quaternion + 4, [](double v) { return v == 0.0; }))
      output.fail(fmt::format("rotations, not (0, 0, 0, 0) at {:g} s", curve.times[key]));
  }
}

}  // namespace

void GltfAnimations::addChannel(const GltfFile& file, const Value& animation, const Value& channel) {
  if (!channel.json.is_object() || !channel.has("target") || !channel.at("target").json.is_object() ||
      !channel.at("target").has("path") || !channel.has("sampler"))
    channel.fail("an object with a target, its path and a sampler");
  const Value target = channel.at("target"), samplers = animation.at("samplers"), number = channel.at("sampler");
  const auto leaveOut = [&](const std::string& why) {
    if (notPlayed_.find(why) == std::string::npos) notPlayed_ += (notPlayed_.empty() ? "" : ", ") + why;
  };
  const auto samplerOf = [&] {
    if (!number.json.is_number_unsigned() || number.json.get<std::size_t>() >= samplers.json.size())
      number.fail(fmt::format("the number of one of {} samplers", samplers.json.size()));
    return samplers.at(number.json.get<std::size_t>());
  };
  std::string name = target.at("path").text();
  std::optional<std::size_t> node;
  if (const auto extension = GltfFile::extension(target, "KHR_animation_pointer"); name == "pointer" && extension) {
    if (!extension->has("pointer")) extension->fail("an object with a pointer");
    const std::string pointer = extension->at("pointer").text();
    if (const auto member = memberIn("nodes", pointer);
        member && std::ranges::find(kPaths, member->second) != std::end(kPaths)) {
      if (member->first >= file.parents().size())
        extension->at("pointer").fail(fmt::format("one of {} nodes", file.parents().size()));
      node = member->first;
      name = member->second;
    } else {
      if (!addProperty(file, samplerOf(), pointer)) leaveOut(fmt::format("'{}'", pointer));
      return;
    }
  }
  const auto known = std::ranges::find(kPaths, name);
  if (!node && target.has("node")) node = file.indexOf(target.at("node"), "nodes");
  if (known == std::end(kPaths) || !node) return leaveOut(fmt::format("target '{}'", name));
  const auto path = static_cast<Path>(known - std::begin(kPaths));
  for (const Channel& other : channels_)
    if (other.node == *node && other.path == path)
      return leaveOut(fmt::format("a second animation of the {} of node {}", name, *node));
  const std::size_t width = path == Path::weights ? 0 : path == Path::rotation ? 4 : 3;
  Curve curve = curveOf(file, samplerOf(), width, fmt::format("node {}", *node));
  curve.isRotation = path == Path::rotation;
  if (path == Path::rotation) checkRotations(curve, samplerOf().at("output"));
  if (path == Path::weights) checkWeights(file, *node, curve, samplerOf().at("output"));
  channels_.push_back({*node, path, std::move(curve)});
}

/// False if nothing here moves it, if there is no such member, or if it is animated already.
bool GltfAnimations::addProperty(const GltfFile& file, const Value& sampler, const std::string& pointer) {
  struct Known {
    std::string_view array, name;
    std::size_t width;
  };
  static constexpr Known kKnown[] = {
      {kMaterials, "emissiveFactor", 3},
      {kMaterials, "extensions/KHR_materials_emissive_strength/emissiveStrength", 1},
      {kMaterials, "pbrMetallicRoughness/baseColorFactor", 4},
      {kMaterials, "pbrMetallicRoughness/metallicFactor", 1},
      {kMaterials, "pbrMetallicRoughness/roughnessFactor", 1},
      {kLights, "color", 3},
      {kLights, "intensity", 1},
  };
  for (const Known& known : kKnown) {
    const auto member = memberIn(known.array, pointer);
    if (!member || member->second != known.name) continue;
    const std::optional<Value> lights = GltfFile::extension(file.root(), "KHR_lights_punctual");
    const std::size_t count = known.array == kMaterials         ? file.count("materials")
                              : lights && lights->has("lights") ? lights->at("lights").json.size()
                                                                : 0;
    if (member->first >= count) return false;
    for (const Property& other : properties_)
      if (other.array == known.array && other.index == member->first && other.name == known.name) return false;
    properties_.push_back({known.array, known.name, member->first, curveOf(file, sampler, known.width, pointer)});
    return true;
  }
  return false;
}

bool GltfAnimations::movesAny(std::string_view array, std::size_t index) const {
  return std::ranges::any_of(properties_, [&](const Property& p) { return p.array == array && p.index == index; });
}

std::vector<double> GltfAnimations::valueAt(std::string_view array, std::size_t index, std::string_view name,
                                            double seconds) const {
  std::vector<double> value;
  for (const Property& property : properties_) {
    if (property.array != array || property.index != index || property.name != name) continue;
    value.resize(property.curve.width);
    property.curve.at(seconds, value);
  }
  return value;
}

void GltfAnimations::setMaterial(GltfMaterial& gltf, std::size_t material, double seconds) const {
  const auto number = [&](std::string_view name, float& factor, double most) {
    if (const std::vector<double> v = valueAt(kMaterials, material, name, seconds); !v.empty())
      factor = static_cast<float>(std::clamp(v[0], 0.0, most));
  };
  const auto colour = [&](std::string_view name, glm::vec3& factor, float most) {
    if (const std::vector<double> v = valueAt(kMaterials, material, name, seconds); !v.empty())
      factor = glm::clamp(glm::vec3(glm::dvec3(v[0], v[1], v[2])), 0.0f, most);
  };
  colour("emissiveFactor", gltf.emissive, 1e30f);
  number("extensions/KHR_materials_emissive_strength/emissiveStrength", gltf.emissiveStrength, 1e30);
  colour("pbrMetallicRoughness/baseColorFactor", gltf.base, 1.0f);
  number("pbrMetallicRoughness/metallicFactor", gltf.metallic, 1.0);
  number("pbrMetallicRoughness/roughnessFactor", gltf.roughness, 1.0);
}

glm::vec3 GltfAnimations::lightAt(std::size_t light, glm::dvec3 colour, double intensity, double seconds) const {
  if (const std::vector<double> v = valueAt(kLights, light, "color", seconds); !v.empty())
    colour = glm::dvec3(v[0], v[1], v[2]);
  if (const std::vector<double> v = valueAt(kLights, light, "intensity", seconds); !v.empty()) intensity = v[0];
  return glm::vec3(glm::max(colour * intensity, glm::dvec3(0.0)));
}

std::map<std::size_t, GltfNodePose> GltfAnimations::at(double seconds) const {
  std::map<std::size_t, GltfNodePose> pose;
  for (const Channel& channel : channels_) {
    std::vector<double> v(channel.curve.width);
    channel.curve.at(seconds, v);
    GltfNodePose& node = pose[channel.node];
    if (channel.path == Path::translation) node.translation = glm::dvec3(v[0], v[1], v[2]);
    else if (channel.path == Path::scale) node.scale = glm::dvec3(v[0], v[1], v[2]);
    else if (channel.path == Path::rotation) node.rotation = glm::dvec4(v[0], v[1], v[2], v[3]);
    else node.weights = v;
  }
  return pose;
}

}  // namespace lucerna
