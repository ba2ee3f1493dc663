#include "render/techniques.hpp"

#include "base/error.hpp"

#include <fmt/ranges.h>

#include <algorithm>

namespace lucerna {

// technique_list.inc is made by engine/CMakeLists.txt: TECHNIQUE(folder) of each.
#define TECHNIQUE(name)       \
  namespace name {            \
  TechniqueEntry technique(); \
  }
#include "technique_list.inc"
#undef TECHNIQUE

namespace {

TechniqueEntry directTechnique() {
  return {.name = "direct",
          .reads = {{"shadows"}, {"textures"}},
          .model = [](const RenderSettings&) { return LightModel{Transport::direct}; },
          .isNeeded = [](const RenderSettings&, const SceneFeatures&) { return false; },
          .make = [](const FrameParts&) { return std::unique_ptr<FrameTechnique>(); }};
}

std::vector<TechniqueEntry>& list() {
#define TECHNIQUE(name) name::technique(),
  static std::vector<TechniqueEntry> techniques{
      directTechnique(),
#include "technique_list.inc"
  };
#undef TECHNIQUE
  return techniques;
}

}  // namespace

const std::vector<TechniqueEntry>& allTechniques() { return list(); }

std::vector<std::string> techniqueNames() {
  std::vector<std::string> names;
  for (const TechniqueEntry& technique : list()) names.emplace_back(technique.name);
  return names;
}

const TechniqueEntry& techniqueNamed(std::string_view name, std::string_view where) {
  const auto found = std::ranges::find(list(), name, &TechniqueEntry::name);
  if (found == list().end())
    throwBadInput("{} {}: unknown; expected one of {}", where, name, fmt::join(techniqueNames(), ", "));
  return *found;
}

AddedTechnique::AddedTechnique(const TechniqueEntry& entry) { list().push_back(entry); }

AddedTechnique::~AddedTechnique() { list().pop_back(); }

}  // namespace lucerna
