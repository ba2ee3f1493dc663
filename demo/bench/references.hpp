// The references of a bench: which there are, who samples them, how long.
#pragma once

#include "commands.hpp"
#include "measure/image_errors.hpp"
#include "measure/reference.hpp"

#include <map>
#include <optional>

namespace lucerna::demo::bench {

struct ReferenceRequest {
  const gl::Context& context;
  gl::ProgramLibrary& programs;
  const Scene& scene;
  const Camera& camera;
  glm::ivec2 size;
  double seconds;                 ///< for all of them together
  std::uint64_t samples = 0;      ///< a pixel; 0: by time
  std::filesystem::path folder;   ///< of the cache; empty: the default
  bool quiet = false;
  bool path = false;               ///< one for the path tracer too, where it sees more than Lambert's surfaces
  std::filesystem::path own = {};  ///< the bench's copies: what its rows were judged by stays, though the cache goes on growing; empty: none
};

/// Indirect light by a difference of pictures, errors in quadrature.
struct References {
  std::map<measure::Transport, measure::Reference> of;
  /// all - direct.
  const measure::Reference& indirect() const { return indirect_; }
  measure::ReferenceNoise noise(const measure::Reference& r) const { return measure::noiseOf(r.mean, r.standardError, r.meanError); }
  const measure::Reference& all() const { return of.at(measure::Transport::all); }
  /// What path tracing is judged by: mirrors, glass and rough metal as they are.
  const measure::Reference& path() const { return own ? *own : all(); }

  std::optional<measure::Reference> own;  ///< none: the scene has surfaces of Lambert's alone
  measure::Reference indirect_;
};

/// Empty where it was interrupted. Throws Error(missingCapability) where nothing can sample them.
std::optional<References> obtainReferences(const ReferenceRequest& request);

/// What the models leave out, on indirect light: RSM gathers without visibility; one bounce has no more. NRMSE and bias over the mean of the fuller transport.
struct ModelError {
  std::string name;
  measure::JudgedErrors errors;
};
std::vector<ModelError> modelErrors(const References& references);

}  // namespace lucerna::demo::bench
