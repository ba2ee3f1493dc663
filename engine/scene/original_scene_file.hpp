// The files of the VPT original (no GL) [VPT2024, 5.3]: OBJ, MTL and a JSON of this form, accepted unchanged.
//   "scene": {"camera", "cameraLookAt": [x,y,z], "fov": degrees across the picture's height, "lightPos", "lightColor":
//   [..], "lightIntensity": number,
//             "scale": millimetres per scene unit (1)}
//   ID:      {"sigma_s", "sigma_a": [r,g,b], 1/mm, "g": [r,g,b], "ior": number}, any number of them
// ID is the name of a material of the MTL, or its index there from 0. Such a material is a smooth dielectric filled
// with that medium; every other one is diffuse with its Kd. The light is one point of radiant intensity lightColor
// times lightIntensity (falloff 1/d^2: the text leaves it open). Ke and Ks of the MTL are ignored, as in the original.
// Keys that begin with // are skipped. The OBJ is in the JSON's folder: the one with the same stem, otherwise the only
// one.
#pragma once

#include "scene/json_value.hpp"
#include "scene/scene.hpp"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace lucerna {

/// Loads a scene from the root of such a JSON. Throws Error(badInput).
Scene loadOriginalScene(const Value& root);

/// A material of an MTL, as far as a draft needs it.
struct MtlEntry {
  std::string name;
  double ior = 1.0;  ///< Ni; 1 if missing
  double opacity = 1.0;  ///< d, or 1 - Tr
};

/// The materials of an MTL in its order. Throws Error(badInput) if there is none.
std::vector<MtlEntry> readMtl(const std::filesystem::path& file);

/// Equivalent of the original's mat_parser.py for an MTL: the text of a scene JSON, meant to be edited. A material
/// whose name resembles a medium of the catalogue gets its coefficients. Any other stays diffuse and is commented out
/// (// before its name), glass with its own ior. Camera and light face the OBJ of the same stem if there is one,
/// otherwise the origin. The second value: one line per material that says what became of it.
std::pair<std::string, std::vector<std::string>> draftOriginalScene(const std::filesystem::path& mtl);

}  // namespace lucerna
