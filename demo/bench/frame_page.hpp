// The page of `lucerna bench frame`: what was measured, as Markdown and as JSON.
#pragma once

#include "bench/frame_passes.hpp"

#include <nlohmann/json_fwd.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace lucerna::demo::bench {

/// Light that a pass adds to the picture, which is black at first.
struct LightStep {
  std::string name;  ///< "direct light"
  std::string_view pass;  ///< its stage
  double error = 0.0;  ///< of the picture with it
  std::string picture;  ///< a file in the page's folder
};

struct MeasuredPass {
  const Pass* pass = nullptr;
  double ms = 0.0, low = 0.0, high = 0.0;  ///< median, 5th and 95th percentile of a frame
  bool runsStill = false;  ///< in frames of a still view, with frame.reuse=on
  std::optional<double> without;  ///< error of the finished picture without the pass, where it was measured
  std::vector<std::string> pictures{};
};

struct MeasuredFrame {
  std::string label;  ///< technique and settings
  std::string technique;
  std::vector<MeasuredPass> passes;  ///< in the order of the frame
  std::vector<LightStep> steps;  ///< the last one is the finished picture
  std::string rest;  ///< a picture of the error that remains
  std::optional<double> unfiltered;  ///< that error with texture.mipmaps=off, where there are textures
};

struct FramePage {
  std::string scene, view, command, renderer, cpu, program;
  int timedFrames = 0;
  std::uint64_t samples = 0;  ///< of the reference, per pixel
  double noise = 0.0;  ///< its share of a relative L2
  double restScale = 0.0;  ///< radiance at the ends of the colours of the pictures of remaining error
  std::vector<MeasuredFrame> frames;
};

/// `folder`: of the pictures, as the page links it.
std::string frameMarkdown(const FramePage& page, const std::string& folder);
nlohmann::ordered_json frameJson(const FramePage& page);

}  // namespace lucerna::demo::bench
