// Pictures 6.1, 6.6 and 7.2 to 7.7 of the LPV original on one sheet, on any scene.
#pragma once

#include "originals/originals.hpp"

#include <optional>

namespace lucerna::demo::bench {

struct LpvPicturesInput {
  const gl::Context& context;
  gl::ProgramLibrary& programs;
  const Scene& scene;
  const Camera& camera;
  RenderSettings usual;  ///< size, fidelity; each picture's changes are applied on top
  std::string fidelity;  ///< its name, for the title
  std::optional<double> exposure;  ///< otherwise the scene's
  bool quiet;
};

/// Without tiles if interrupted.
VptSheet drawLpvPictures(const LpvPicturesInput& input);

}  // namespace lucerna::demo::bench
