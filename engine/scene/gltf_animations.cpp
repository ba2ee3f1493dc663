#include "scene/gltf_animations.hpp"

#include <algorithm>

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

void GltfAnimations::addChannel(const GltfFile& file, const Value& animation, const Value& channel) {
  if (!channel.json.is_object() || !channel.has("target") || !channel.at("target").json.is_object() ||
      !channel.at("target").has("path") || !channel.has("sampler"))
    channel.fail("an object with a target, its path and a sampler");
  const Value target = channel.at("target");
  const std::string name = target.at("path").text();
  const auto leaveOut = [&](const std::string& why) {
    if (notPlayed_.find(why) == std::string::npos) notPlayed_ += (notPlayed_.empty() ? "" : ", ") + why;
  };
  constexpr std::string_view kPaths[] = {"translation", "rotation", "scale", "weights"};
  const auto known = std::ranges::find(kPaths, name);
  if (known == std::end(kPaths) || !target.has("node")) return leaveOut(fmt::format("target '{}'", name));
  const auto path = static_cast<Path>(known - std::begin(kPaths));
  const std::size_t node = file.indexOf(target.at("node"), "nodes");
  for (const Channel& other : channels_)
    if (other.node == node && other.path == path)
      return leaveOut(fmt::format("a second animation of the {} of node {}", name, node));
  const Value samplers = animation.at("samplers"), number = channel.at("sampler");
  if (!number.json.is_number_unsigned() || number.json.get<std::size_t>() >= samplers.json.size())
    number.fail(fmt::format("the number of one of {} samplers", samplers.json.size()));
  channels_.push_back({node, path, curveOf(file, samplers.at(number.json.get<std::size_t>()), path, node)});
}

Curve GltfAnimations::curveOf(const GltfFile& file, const Value& sampler, Path path, std::size_t node) const {
  if (!sampler.json.is_object() || !sampler.has("input") || !sampler.has("output"))
    sampler.fail("an object with input and output");
  const GltfNumbers times = file.numbers(file.indexOf(sampler.at("input"), "accessors"), "SCALAR");
  const GltfNumbers values =
      file.numbers(file.indexOf(sampler.at("output"), "accessors"), path == Path::weights    ? "SCALAR"
                                                                    : path == Path::rotation ? "VEC4"
                                                                                             : "VEC3");
  Curve curve;
  const std::string interpolation = sampler.has("interpolation") ? sampler.at("interpolation").text() : "LINEAR";
  if (interpolation == "STEP") curve.interpolation = Curve::Interpolation::step;
  else if (interpolation == "CUBICSPLINE") curve.interpolation = Curve::Interpolation::tangents;
  else if (interpolation != "LINEAR") sampler.at("interpolation").fail("LINEAR, STEP or CUBICSPLINE");
  curve.isRotation = path == Path::rotation;
  for (std::size_t i = 0; i < times.count; ++i) {
    const double time = times.at(i, 0);
    if (!std::isfinite(time) || (i > 0 && !(time > curve.times.back())))
      sampler.at("input").fail("times that are finite and rise");
    curve.times.push_back(time);
  }
  const std::size_t perKey = curve.interpolation == Curve::Interpolation::tangents ? 3 : 1;
  const std::size_t elements = times.count == 0 ? 0 : values.count / (times.count * perKey);
  if (elements == 0 || elements * times.count * perKey != values.count || (path != Path::weights && elements != 1))
    sampler.at("output").fail(fmt::format("values for {} times of node {}, not {}", times.count, node, values.count));
  curve.width = values.width * elements;
  for (std::size_t i = 0; i < values.count; ++i)
    for (std::size_t k = 0; k < values.width; ++k) {
      curve.values.push_back(values.at(i, k));
      if (!std::isfinite(curve.values.back())) sampler.at("output").fail("values that are finite");
    }
  return curve;
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
