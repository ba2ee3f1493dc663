// What each pass of a frame does, in words and by its sources, and its result as a picture; for `lucerna bench frame`.
#pragma once

#include "shared/glyphs.hpp"
#include "shared/stage_view.hpp"

#include <string_view>
#include <vector>

namespace lucerna::demo::bench {

struct Pass {
  /// The part of the picture that is missing without the pass.
  enum class Gives {
    sunShadows,
    lampShadows,
    surfaces,  ///< everything but the background
    indirect,  ///< or what is missing with the setting `without`
    environment,
    shafts,
    display,  ///< nothing of the linear picture
  };
  std::string_view name;  ///< of the stage, as the timer reports it
  std::string_view title;
  std::string_view does;  ///< one or two sentences
  std::vector<std::string_view> sources;  ///< C++ first
  Gives gives;
  std::vector<std::string_view> pictures = {};  ///< ends of the names of its stage pictures
  Glyphs glyphs = Glyphs::none;  ///< its result drawn in the scene
  std::string_view without = "";  ///< a setting that switches off this pass alone
};

/// Throws Error(fault) for a stage that has no description here.
const Pass& passNamed(std::string_view name);

/// The pass's stage pictures side by side, with their names: depth stretched to the whole range, light exposed, of
/// volumes one slice. Empty if it has none. Valid after a frame.
Bitmap stageSheet(const Pass& pass, const Renderer& renderer, StageView& view, const Scene& scene);
/// Its glyphs over the darkened picture, of one cascade.
Bitmap glyphPicture(Glyphs glyphs, const Renderer& renderer, gl::ProgramLibrary& programs, const Scene& scene,
                    const Camera& camera);

}  // namespace lucerna::demo::bench
