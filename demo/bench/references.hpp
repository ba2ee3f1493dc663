// The references of a bench: their kinds, their sampler and their time; and judging pictures by them.
#pragma once

#include "bench/light_model.hpp"
#include "shared/commands.hpp"
#include "measure/image_errors.hpp"
#include "measure/reference.hpp"
#include "shared/parts.hpp"

#include <map>
#include <optional>

namespace lucerna::demo::bench {

/// A technique of the bench, and the light it promises (modelOf, restricted to the kinds in the scene).
struct TechniqueModel {
  std::string technique;
  LightPaths paths;
  measure::LightKinds direct;  ///< kinds whose direct light it shows
  bool operator==(const TechniqueModel&) const = default;
};

struct ReferenceRequest {
  const gl::Context& context;
  gl::ProgramLibrary& programs;
  const Scene& scene;
  const Camera& camera;
  glm::ivec2 size;
  PixelFilter filter;
  double seconds;  ///< for all of them together
  std::vector<TechniqueModel> models;  ///< of the points
  std::uint64_t samples = 0;  ///< per pixel; 0: by time
  std::filesystem::path folder;  ///< of the cache; empty: the default
  bool quiet = false;
  bool path = false;  ///< also one for the path tracer, if it sees more than Lambertian surfaces
  std::filesystem::path own =
      {};  ///< the bench's own copies, which its rows were judged by, while the cache grows; empty: none
};

/// A picture against a reference. Directly visible lights and background are no achievement and would hide the rest: a
/// lamp in view has nearly all of sum r^2. So relative errors other than NRMSE are of the light scattered by surfaces:
/// both pictures minus the visible lights.
struct JudgedPicture {
  measure::JudgedErrors pixels;  ///< of the full pictures
  measure::JudgedErrors scattered;  ///< of scattered light
  measure::JudgedErrors blocks;  ///< the same averaged over blocks of 1/16 of the width
  measure::PartErrors lit, other;
  /// Standard errors of l2, nrmse and relmse due to the reference's noise; NaN where the error is 0.
  double l2Error = 0.0, nrmseError = 0.0, relmseError = 0.0;
};

struct References {
  std::map<LightPaths, measure::Reference> of;  ///< for kinds of light in the scene
  measure::LightKinds lights;  ///< those of the scene
  std::vector<TechniqueModel> models;
  /// all - direct: a difference of pictures, with errors added in quadrature.
  const measure::Reference& indirect() const { return indirect_; }
  measure::ReferenceNoise noise(const measure::Reference& r) const {
    return measure::noiseOf(r.mean, r.standardError, r.meanError);
  }
  const measure::Reference& all() const { return of.at({Transport::all, lights}); }
  /// The reference for path tracing: mirrors, glass and rough metal as they are.
  const measure::Reference& path() const { return own ? *own : all(); }
  /// The reference for a technique inside its model. Lights of unsupported kinds are still visible in it, as they would
  /// be with any technique.
  measure::Reference inside(const LightPaths& paths) const;
  /// Only the visible lights and background, where the reference shows them.
  Image blackPicture(const measure::Reference& reference) const;
  /// The best picture of one constant irradiance: `reference` without any light transport.
  Image constantPicture(const measure::Reference& reference) const;
  /// `surfacesAlone`: excludes the background, which is equal by definition.
  JudgedPicture judge(const Image& picture, const measure::Reference& reference, bool surfacesAlone = false,
                      double ownError = 0.0) const;

  std::optional<measure::Reference> own;  ///< none: the scene has only Lambertian surfaces
  measure::Reference indirect_;
  Image albedo;  ///< of visible surfaces; 0 in the background
  /// Visible lights and background of the scene lit by these kinds alone.
  std::map<measure::LightKinds, Image> seen;
  std::vector<bool> emitterEdges;  ///< pixels that an emissive surface covers in part: no light is judged there
  std::vector<bool> lit, other;  ///< surface pixels with direct light of sun and lamps, and without
};

/// Empty if interrupted. Throws Error(missingCapability) if they cannot be sampled.
std::optional<References> obtainReferences(const ReferenceRequest& request);

/// The references that obtainReferences() requests from the cache, by number of samples, cut into batches. Those of a
/// part are stored in its folder; all together are stored in the cache, with the same bits as from one run. `command`
/// and `identity`: the folder's (parts.hpp).
struct ReferenceBatches {
  std::size_t batches = 0, made = 0;  ///< in the part; made in this run
  std::vector<std::filesystem::path> stored;  ///< in the cache; none for a part
  bool complete = false;  ///< false: interrupted
};
ReferenceBatches sampleReferences(const ReferenceRequest& request, const PartOptions& part,
                                  const std::string& identity);
/// Whether the cache holds all of them with the requested samples.
bool hasReferences(const ReferenceRequest& request);

/// The error of the models themselves, whatever the settings: one line each for visibility, for bounces, and for the
/// kinds of light that a technique lacks. Errors are relative to the fuller of both.
struct ModelError {
  std::string name;
  std::string of;  ///< the compared light, such as "indirect light"
  measure::JudgedErrors errors;
};
std::vector<ModelError> modelErrors(const References& references);

}  // namespace lucerna::demo::bench
