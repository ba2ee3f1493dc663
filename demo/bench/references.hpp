// The references of a bench: which there are, who samples them, how long; and pictures judged by them.
#pragma once

#include "bench/light_model.hpp"
#include "commands.hpp"
#include "measure/image_errors.hpp"
#include "measure/reference.hpp"
#include "parts.hpp"

#include <map>
#include <optional>

namespace lucerna::demo::bench {

/// A technique of the bench, and what light it promises (modelOf, of the kinds that the scene has).
struct TechniqueModel {
  std::string technique;
  LightPaths paths;
  measure::LightKinds direct;  ///< whose direct light it shows
  bool operator==(const TechniqueModel&) const = default;
};

struct ReferenceRequest {
  const gl::Context& context;
  gl::ProgramLibrary& programs;
  const Scene& scene;
  const Camera& camera;
  glm::ivec2 size;
  double seconds;  ///< for all of them together
  std::vector<TechniqueModel> models;  ///< of the rungs
  std::uint64_t samples = 0;  ///< a pixel; 0: by time
  std::filesystem::path folder;  ///< of the cache; empty: the default
  bool quiet = false;
  bool path = false;  ///< one for the path tracer too, where it sees more than Lambert's surfaces
  std::filesystem::path own =
      {};  ///< the bench's copies: what its rows were judged by stays, though the cache goes on growing; empty: none
};

/// A picture against a reference. What is seen of lights and background themselves is no achievement and would hide
/// what is: a lamp in view has nearly all of sum r^2. So relative errors other than NRMSE are of the light that
/// surfaces scatter: both pictures less what is seen of lights.
struct JudgedPicture {
  measure::JudgedErrors pixels;  ///< as the pictures are
  measure::JudgedErrors scattered;  ///< of scattered light
  measure::JudgedErrors blocks;  ///< the same averaged over blocks of 1/16 of the width
  measure::PartErrors lit, other;
  /// Standard errors that the reference's noise gives to l2, nrmse and relmse; NaN where the error is 0.
  double l2Error = 0.0, nrmseError = 0.0, relmseError = 0.0;
};

struct References {
  std::map<LightPaths, measure::Reference> of;  ///< of kinds of light that the scene has
  measure::LightKinds lights;  ///< those of the scene
  std::vector<TechniqueModel> models;
  /// all - direct: a difference of pictures, errors in quadrature.
  const measure::Reference& indirect() const { return indirect_; }
  measure::ReferenceNoise noise(const measure::Reference& r) const {
    return measure::noiseOf(r.mean, r.standardError, r.meanError);
  }
  const measure::Reference& all() const { return of.at({Transport::all, lights}); }
  /// What path tracing is judged by: mirrors, glass and rough metal as they are.
  const measure::Reference& path() const { return own ? *own : all(); }
  /// What a technique is judged by inside its model. Lights that its kinds lack are seen in it all the same: they would
  /// be by any technique.
  measure::Reference inside(const LightPaths& paths) const;
  /// Nothing but what is seen of lights and background, where the reference shows them.
  Image blackPicture(const measure::Reference& reference) const;
  /// The best picture of one constant irradiance: what `reference` would be without any transport of light.
  Image constantPicture(const measure::Reference& reference) const;
  /// `surfacesAlone`: what lies behind the scene is equal by definition.
  JudgedPicture judge(const Image& picture, const measure::Reference& reference, bool surfacesAlone = false,
                      double ownError = 0.0) const;

  std::optional<measure::Reference> own;  ///< none: the scene has surfaces of Lambert's alone
  measure::Reference indirect_;
  Image albedo;  ///< of what is seen; 0 behind the scene
  /// Lights and background themselves, of the scene lit by these kinds alone.
  std::map<measure::LightKinds, Image> seen;
  std::vector<bool> lit, other;  ///< surface pixels with direct light of sun and lamps, and without
};

/// Empty where it was interrupted. Throws Error(missingCapability) where nothing can sample them.
std::optional<References> obtainReferences(const ReferenceRequest& request);

/// The references that obtainReferences() asks the cache for, by a number of samples, cut into batches: those of a part
/// are kept in its folder; all together are stored in the cache, the same bits as of one run. `command` and `identity`:
/// the folder's (parts.hpp).
struct ReferenceBatches {
  std::size_t batches = 0, made = 0;  ///< of the part; made now
  std::vector<std::filesystem::path> stored;  ///< in the cache; none of a part
  bool complete = false;  ///< false: interrupted
};
ReferenceBatches sampleReferences(const ReferenceRequest& request, const PartOptions& part,
                                  const std::string& identity);
/// Whether the cache holds all of them with the samples that are asked for.
bool hasReferences(const ReferenceRequest& request);

/// What the models leave out, whatever the settings: a line for visibility, for bounces, and for the kinds of light
/// that a technique has not. Errors over the fuller of both.
struct ModelError {
  std::string name;
  std::string of;  ///< the light that is compared, such as "indirect light"
  measure::JudgedErrors errors;
};
std::vector<ModelError> modelErrors(const References& references);

}  // namespace lucerna::demo::bench
