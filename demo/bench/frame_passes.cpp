#include "bench/frame_passes.hpp"

#include "base/error.hpp"
#include "gl/read_pictures.hpp"
#include "gl/lines.hpp"
#include "shared/contact_sheet.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace lucerna::demo::bench {

namespace {

using Gives = Pass::Gives;

const Pass kPasses[] = {
    {"shadow",
     "Shadow map of the sun",
     "Draws the depth of the scene as the sun sees it. A surface point behind that depth is in shadow.",
     {"engine/forward/sun_shadow.cpp", "shaders/forward/depth.vert", "shaders/forward/sun_shadow.glsl"},
     Gives::sunShadows,
     {"shadow map", "sun cascades"}},
    {"spot shadows",
     "Shadow maps of spot lights",
     "Draws the depth of the scene as each spot light sees it.",
     {"engine/forward/local_lights.cpp", "shaders/forward/depth_layered.geom", "shaders/forward/lights.glsl"},
     Gives::lampShadows},
    {"point shadows",
     "Shadow maps of omnidirectional lights",
     "Draws the depth of the scene as each lamp sees it, on the six faces of a cube.",
     {"engine/forward/local_lights.cpp", "shaders/forward/depth_layered.geom", "shaders/forward/lights.glsl"},
     Gives::lampShadows},
    {"rsm",
     "Reflective shadow maps",
     "Draws the surfaces that each light sees: the flux that they reflect, their normals and positions. Every texel "
     "is a small lamp.",
     {"engine/rsm/reflective_shadow_map.cpp", "shaders/rsm/rsm.frag"},
     Gives::indirect,
     {"1 flux", "1 normal", "1 position"}},
    {"geometry",
     "Depth and normals",
     "Draws depth and the normal of the surface in each pixel. Later passes look up light at these points, and "
     "shading draws only surfaces of equal depth.",
     {"engine/forward/visible_surfaces.cpp", "shaders/forward/visible.frag"},
     Gives::surfaces,
     {"normals", "depth"}},
    {"gather low",
     "Gather at few pixels",
     "Adds up the light of the reflective shadow maps' texels at every fourth pixel in each direction.",
     {"engine/rsm/rsm_gather.cpp", "shaders/rsm/gather_low.comp", "shaders/rsm/gather.glsl"},
     Gives::indirect},
    {"interpolation",
     "Interpolation",
     "Interpolates the other pixels from gathered ones whose positions and normals fit, and lists the rest.",
     {"engine/rsm/rsm_gather.cpp", "shaders/rsm/interpolate.comp"},
     Gives::indirect,
     {},
     Glyphs::none,
     "rsm.interpolate=off"},
    {"gather full",
     "Gather at the other pixels",
     "Gathers at the pixels that could not be interpolated: at edges, and on small surfaces.",
     {"engine/rsm/rsm_gather.cpp", "shaders/rsm/gather_refused.comp"},
     Gives::indirect},
    {"irradiance cache",
     "Irradiance cache",
     "Finds a point, a record, for each grid cell that the camera sees. From each record it traces `cache.rays` paths "
     "per frame, up to `cache.samples`. A disk is a record of the finest cascade, in the colour of its "
     "irradiance.",
     {"engine/irradiance_cache/irradiance_cache.cpp", "shaders/irradiance_cache/mark.comp",
      "shaders/irradiance_cache/paths.comp", "shaders/irradiance_cache/store.comp"},
     Gives::indirect,
     {},
     Glyphs::records},
    {"camera surfels",
     "Surfels of the camera",
     "Draws the surfaces that the camera sees into a map, from which they enter the geometry volume.",
     {"engine/lpv/lpv_frame.cpp", "shaders/rsm/rsm.frag"},
     Gives::indirect,
     {},
     Glyphs::none,
     "lpv.blocking=rsm"},
    {"injection",
     "Injection",
     "Adds the light of each texel of the reflective shadow maps to the cell in front of it, as two bands of "
     "spherical harmonics.",
     {"engine/lpv/injection.cpp", "shaders/lpv/inject.vert", "shaders/lpv/inject.frag"},
     Gives::indirect,
     {"injected light"}},
    {"geometry volume",
     "Geometry volume",
     "Adds up in each cell how much the surfaces in it block. A box is a blocking cell, larger where it blocks more.",
     {"engine/lpv/geometry_volume.cpp", "shaders/lpv/geometry_volume.frag"},
     Gives::indirect,
     {},
     Glyphs::geometry,
     "lpv.blocking=off"},
    {"propagation",
     "Propagation",
     "Carries light from cell to cell, step by step, and joins the cascades. A lobe shows the light of a bright "
     "cell by direction.",
     {"engine/lpv/propagation.cpp", "engine/lpv/cascade_join.cpp", "shaders/lpv/propagate.comp"},
     Gives::indirect,
     {"propagated light"},
     Glyphs::lobes,
     "lpv.iterations=0"},
    {"shading",
     "Shading",
     "Draws depth, unless it is known, then the visible surfaces: their emission, the direct light of sun and lamps, "
     "and the light found by the previous passes.",
     {"engine/render/renderer.cpp", "shaders/forward/surface.glsl"},
     Gives::surfaces},
    {"environment",
     "Environment",
     "Draws the sky or the surrounding picture where there is no surface.",
     {"engine/forward/environment_view.cpp", "shaders/forward/environment.frag"},
     Gives::environment},
    {"light shafts",
     "Light shafts",
     "Adds the light that haze scatters towards the camera along each pixel's ray.",
     {"engine/lpv/light_shafts.cpp", "shaders/lpv/shafts.comp"},
     Gives::shafts,
     {},
     Glyphs::none,
     "lpv.shafts=off"},
    {"tone mapping",
     "Tone mapping",
     "Turns radiance into display values. Left, radiance times exposure, cut off at 1; right, by the filmic curve.",
     {"engine/render/renderer.cpp", "shaders/forward/tonemap.frag"},
     Gives::display},
};

}  // namespace

const Pass& passNamed(std::string_view name) {
  for (const Pass& pass : kPasses)
    if (pass.name == name) return pass;
  throw Error(ErrorKind::fault, fmt::format("internal error: bench frame has no description of stage '{}'", name));
}

namespace {

constexpr int kTileSide = 256;

/// Scaled by whole numbers, so that no texel is lost or smeared, to about the height of a tile.
Bitmap tileOf(const Image& image) {
  const int shrink = std::max(static_cast<int>(std::lround(static_cast<double>(image.height) / kTileSide)), 1);
  const int grow = std::max(kTileSide / image.height, 1);
  Bitmap bitmap;
  bitmap.width = image.width / shrink * grow;
  bitmap.height = image.height / shrink * grow;
  for (int y = 0; y < bitmap.height; ++y)
    for (int x = 0; x < bitmap.width; ++x) {
      glm::vec3 sum(0.0f);
      for (int v = 0; v < shrink; ++v)
        for (int u = 0; u < shrink; ++u)
          sum += glm::clamp(image.at(x / grow * shrink + u, y / grow * shrink + v), 0.0f, 1.0f);
      for (int c = 0; c < 3; ++c)
        bitmap.rgba.push_back(
            static_cast<std::uint8_t>(std::lround(255.0f * sum[c] / static_cast<float>(shrink * shrink))));
      bitmap.rgba.push_back(255);
    }
  return bitmap;
}

/// Depth as the stage view shows it: 0 behind everything. The rest is stretched, so that near is white.
void stretch(Image& image) {
  float least = 1.0f, most = 0.0f;
  for (const glm::vec3& p : image.pixels)
    if (p.x > 0.0f) least = std::min(least, p.x), most = std::max(most, p.x);
  for (glm::vec3& p : image.pixels)
    if (p.x > 0.0f) p = glm::vec3(0.1f + 0.9f * (p.x - least) / std::max(most - least, 1e-6f));
}

/// Of the first volume, so that all volumes show the same cells; of others the first layer.
int brightestLayer(const Renderer& renderer, StageView& view, const Bounds& bounds) {
  int brightest = 0;
  double most = -1.0;
  for (const StagePicture& picture : renderer.stagePictures()) {
    if (picture.kind != StagePicture::Kind::coefficients) continue;
    for (int layer = 0; layer < StageView::layersOf(picture); ++layer) {
      const glm::dvec3 mean = meanOf(gl::readImage(view.recordUnscaled(picture, layer, bounds)));
      if (mean.x + mean.y + mean.z > most) brightest = layer, most = mean.x + mean.y + mean.z;
    }
    break;
  }
  return brightest;
}

}  // namespace

Bitmap stageSheet(const Pass& pass, const Renderer& renderer, StageView& view, const Scene& scene) {
  Bounds bounds = scene.bounds;
  bounds.min -= renderer.origin(), bounds.max -= renderer.origin();
  std::vector<Tile> tiles;
  for (const StagePicture& picture : renderer.stagePictures()) {
    if (std::ranges::none_of(pass.pictures, [&](std::string_view end) { return picture.name.ends_with(end); }))
      continue;
    const bool isVolume = picture.kind == StagePicture::Kind::coefficients;
    const int layer = isVolume ? brightestLayer(renderer, view, bounds) : 0, layers = StageView::layersOf(picture);
    Image image = gl::readImage(view.record(picture, layer, 1.0f, bounds));
    if (picture.kind == StagePicture::Kind::depth) stretch(image);
    tiles.push_back({layers > 1 ? fmt::format("{}, layer {} of {}", picture.name, layer + 1, layers) : picture.name,
                     tileOf(image)});
  }
  return tiles.empty() ? Bitmap{} : contactSheet("", tiles, static_cast<int>(tiles.size()));
}

Bitmap glyphPicture(Glyphs glyphs, const Renderer& renderer, gl::ProgramLibrary& programs, const Scene& scene,
                    const Camera& camera) {
  // Records and blocking cells of the finest cascade; lobes of the next, whose cells are larger and carry light
  // further.
  const bool isLobes = glyphs == Glyphs::lobes;
  const int most = glyphs == Glyphs::records ? 4000 : isLobes ? 1000 : 400;
  const auto lines = glyphsOf(glyphs, renderer, scene, camera, isLobes ? 1 : 0, most);
  std::vector<glm::vec4> dark = renderer.display().readRgba();
  std::vector<float> values;
  for (const glm::vec4& texel : dark)
    for (int c = 0; c < 4; ++c) values.push_back(c < 3 ? 0.35f * texel[c] : 1.0f);
  gl::Texture target("glyphs", gl::Format::rgba32f, renderer.size());
  target.upload(gl::Texels::rgbaFloat, values.data());
  const std::array<const gl::Texture*, 1> colors{&target};
  const gl::Framebuffer framebuffer("glyphs", colors);
  const glm::vec2 size(renderer.size());
  gl::Lines(programs).draw(framebuffer, {{0, 0}, renderer.size(), 0.5f * size, glm::vec2(0.5f), size},
                           renderer.linesView(camera, scene.bounds), lines, 1.5f);
  Image image = gl::readImage(target);
  Bitmap bitmap;
  bitmap.width = image.width, bitmap.height = image.height;
  for (const glm::vec3& p : image.pixels)
    for (int c = 0; c < 4; ++c)
      bitmap.rgba.push_back(c < 3 ? static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(p[c], 0.0f, 1.0f)))
                                  : 255);
  return bitmap;
}

}  // namespace lucerna::demo::bench
