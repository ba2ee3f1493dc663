// The files of the VPT original (no GL) [VPT2024, 5.3]: OBJ, MTL and a JSON of this form, accepted unchanged.
//   "scene": {"camera", "cameraLookAt": [x,y,z], "fov": degrees across the picture's height, "lightPos", "lightColor":
//   [..], "lightIntensity": number,
//             "scale": millimetres a scene unit (1)}
//   ID:      {"sigma_s", "sigma_a": [r,g,b], 1/mm, "g": [r,g,b], "ior": number}, any number of them
// ID is the name of a material of the MTL, or its number there from 0. Such a material is a smooth dielectric filled
// with that medium; every other one is diffuse with its Kd. The light is one point of radiant intensity lightColor
// times lightIntensity (falloff 1/d^2: the text leaves it open). Ke and Ks of the MTL are ignored, as there. Keys that
// begin with // are skipped. The OBJ is in the JSON's folder: the one of the same stem, else the only one.
#pragma once

#include "scene/json_value.hpp"
#include "scene/scene.hpp"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace lucerna {

/// From the root of such a JSON. Throws Error(badInput).
Scene loadOriginalScene(const Value& root);

/// A material of an MTL, as far as a draft needs it.
struct MtlEntry {
  std::string name;
  double ior = 1.0;  ///< Ni; 1 if missing
  double opacity = 1.0;  ///< d, or 1 - Tr
};

/// The materials of an MTL in its order. Throws Error(badInput) if there is none.
std::vector<MtlEntry> readMtl(const std::filesystem::path& file);

/// What the original's mat_parser.py made of an MTL: the text of a scene JSON to be edited. A material whose name
/// resembles a medium of the catalogue gets its coefficients; any other stays diffuse and is commented out (// before
/// its name), glass with its own ior. Camera and light look at the OBJ of the same stem if there is one, else at the
/// origin. The second value: one line per material, what became of it.
std::pair<std::string, std::vector<std::string>> draftOriginalScene(const std::filesystem::path& mtl);

}  // namespace lucerna
