// The keys "media", "materials" and "cameraMedium" of the scene JSON (no GL).
//   "media":        {NAME: a name of the catalogue, or {
//                      "catalogue": base values for the rest (default: neither scattering nor absorption),
//                      "sigma_s", "sigma_a": [r,g,b], 1/mm; "g": [r,g,b] or one number, above -1 and below 1;
//                      "ior": relative to vacuum (1, or the catalogue's), "concentration": scales sigma_s and sigma_a;
//                      "phase": "henyey-greenstein" or "rayleigh"; "emission": [r,g,b], radiance per mm,
//                      "grid": {"file": see density_file.hpp, "size": [x,y,z] cells (needed for .raw),
//                               "min", "max": [x,y,z] its box in scene units, "factor": on its density}}}
//   "materials":    {NAME in the model: {"bsdf": "diffuse", "mirror", "conductor", "dielectric" or "none",
//                      "ior" (the interior's), "roughness": 0..1,
//                      "interior": a name of "media" or of the catalogue, or null: its content; alone it implies a
//                      dielectric, "priority": integer, the higher one applies where dielectrics overlap,
//                      "diffuse", "specular": [r,g,b] 0..1, "emission": [r,g,b], radiance}}
//   "cameraMedium": a name of "media" or of the catalogue, around everything and without an end: light of sun and sky
//                   does not get through it
// Coefficients are per millimetre, so a scene with media must give its "scale".
#pragma once

#include "scene/json_value.hpp"
#include "scene/scene.hpp"

#include <optional>

namespace lucerna {

/// Reads those keys of the JSON's root into a scene whose model is loaded. `millimetresPerUnit`: empty if the scene
/// does not give it.
void readSceneMedia(const Value& root, std::optional<double> millimetresPerUnit, Scene& scene);

/// Within the valid range; shared with the original's JSON.
glm::vec3 readAnisotropy(const Value& value);
double readIor(const Value& value);
/// sigma_s or sigma_a, 1/mm.
glm::dvec3 readCoefficient(const Value& value);

}  // namespace lucerna
