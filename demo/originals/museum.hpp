// The museum of mistakes: every deviation of the project as a room. And the mystery: a picture with one of them hidden
// in it.
#pragma once

#include "gl/context.hpp"
#include "gl/program.hpp"
#include "render/renderer.hpp"

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace lucerna::demo::labs {

struct Room {
  const char* deviation;  ///< in the form that --deviation takes
  const char* symptom;  ///< what is noticeable by eye or by an instrument
  const char* cause;
  const char* published;  ///< formula with the mistake
  const char* right;
  const char* instrument;  ///< how to find it
  const char* test;  ///< FILE: NAME of the test that catches it
};
std::span<const Room> museumRooms();

/// One self-contained page of the rooms. Each has three pictures (correct, with the deviation, and their difference) of
/// the Cornell box or, for the path tracer, of a scene in demo/labs/museum. Small: a quarter of the samples and a tenth
/// of radiosity's patches.
std::string museumHtml(const gl::Context& context, gl::ProgramLibrary& programs, std::span<const Room> rooms,
                       bool small, const std::function<void(int done, int all)>& progress);

/// The mystery: a deviation determined by the seed alone.
struct Mystery {
  std::string technique;  ///< "rsm", "lpv" or "path"
  std::vector<std::string> candidates;  ///< for that technique
  std::string hidden;
};
Mystery mysteryOf(const std::string& seed);

/// Readings of the instruments with the hidden deviation and without any: mean indirect radiance under several
/// settings; for the path tracer the white furnace, and the two halves of a picture with and without a lamp.
struct Reading {
  std::string instrument;
  double sound = 0.0, hidden = 0.0;
};
struct Readings {
  std::vector<Reading> readings;
  Image sound, hidden;
};
Readings readInstruments(const gl::Context& context, gl::ProgramLibrary& programs, const std::string& technique,
                         const std::string& deviation);

}  // namespace lucerna::demo::labs
