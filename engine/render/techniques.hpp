// The list of techniques (no GL calls). engine/CMakeLists.txt has a line for each: lucerna_technique(NAME ...).
#pragma once

#include "frame/technique.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

/// In the order of engine/CMakeLists.txt, after "direct", which adds nothing to direct light.
const std::vector<TechniqueEntry>& allTechniques();
/// Throws Error(badInput) that begins with `where` and lists the names.
const TechniqueEntry& techniqueNamed(std::string_view name, std::string_view where = "technique");
std::vector<std::string> techniqueNames();

/// Adds a technique of a program's own, whose shaders are in the program library's folder; removes it again at the end
/// of its life. Not while a Renderer or a reference to a setting exists.
class AddedTechnique {
 public:
  explicit AddedTechnique(const TechniqueEntry& entry);
  ~AddedTechnique();
  AddedTechnique(const AddedTechnique&) = delete;
  AddedTechnique& operator=(const AddedTechnique&) = delete;
};

}  // namespace lucerna
