// lucerna lab museum and lucerna lab mystery: the parts of the labs that need the renderer.
#include "base/error.hpp"
#include "base/files.hpp"
#include "shared/commands.hpp"
#include "originals/originals.hpp"
#include "originals/museum.hpp"
#include "measure/heat_map.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <span>
#include <string_view>
#include <vector>

namespace lucerna::demo {

namespace {

using namespace labs;
namespace fs = std::filesystem;

struct MuseumOptions {
  CommonOptions common;
  std::string seed, answer, folder = ".", html = "museum.html", room;
  bool small = false;
};

int museum(const MuseumOptions& options) {
  options.common.apply();
  std::span<const Room> rooms = museumRooms();
  if (!options.room.empty()) {
    const auto isIt = [&](const Room& room) { return options.room == room.deviation; };
    const auto found = std::find_if(rooms.begin(), rooms.end(), isIt);
    if (found == rooms.end()) {
      std::vector<std::string_view> names;
      for (const Room& room : rooms) names.push_back(room.deviation);
      throwBadInput("--room {}: expected a deviation, one of {}", options.room, fmt::join(names, ", "));
    }
    rooms = {found, 1};
  }
  const auto host = options.common.makeHost(false);
  const gl::Context context;
  gl::ProgramLibrary programs;
  Progress progress("Rooms", static_cast<int>(rooms.size()), options.common.quiet);
  const auto update = [&](int done, int) { progress.update(done); };
  writeFileAtomically(options.html, museumHtml(context, programs, rooms, options.small, update));
  fmt::print("{}: {} {}\n", options.html, rooms.size(), rooms.size() == 1 ? "room" : "rooms");
  return 0;
}

/// Prints the hidden deviation's readings next to correct ones; with --answer the answer is graded instead, without a
/// GPU.
int mystery(const MuseumOptions& options) {
  options.common.apply();
  const Mystery mystery = mysteryOf(options.seed);
  if (!options.answer.empty()) {
    if (std::find(mystery.candidates.begin(), mystery.candidates.end(), options.answer) == mystery.candidates.end())
      throwBadInput("--answer {}: not one of {}", options.answer, fmt::join(mystery.candidates, ", "));
    const bool right = options.answer == mystery.hidden;
    fmt::print("seed {}: {} is {}\n", options.seed, options.answer, right ? "right" : "not it");
    options.common.writeJson(
        {{"seed", options.seed}, {"answer", options.answer}, {"right", right}, {"score", right ? 100 : 0}});
    return right ? 0 : static_cast<int>(ErrorKind::badInput);
  }
  const auto host = options.common.makeHost(false);
  const gl::Context context;
  gl::ProgramLibrary programs;
  const bool traced = mystery.technique == "path";
  const Readings readings = readInstruments(context, programs, mystery.technique, mystery.hidden);
  fmt::print(
      "Mystery of seed {}: {} by technique {}, one deviation is on. Mean {}radiance:\n{:<20}{:>12}{:>12}{:>10}\n",
      options.seed, traced ? "a ball of fog and one of water" : "a Cornell box", mystery.technique,
      traced ? "" : "indirect ", "instrument", "sound", "mystery", "ratio");
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const Reading& r : readings.readings) {
    fmt::print("{:<20}{:>12.5g}{:>12.5g}{:>10.4f}\n", r.instrument, r.sound, r.hidden, r.hidden / r.sound);
    rows.push_back({{"instrument", r.instrument}, {"sound", r.sound}, {"mystery", r.hidden}});
  }
  std::error_code error;
  fs::create_directories(options.folder, error);
  if (error) throwBadInput("{}: {}", options.folder, error.message());
  const double scale = measure::heatMapScale(readings.hidden, readings.sound);
  writePng(fs::path(options.folder) / "sound.png", toneMapped(readings.sound, traced ? 1.0f : 4.0f));
  writePng(fs::path(options.folder) / "mystery.png", toneMapped(readings.hidden, traced ? 1.0f : 4.0f));
  writePng(fs::path(options.folder) / "heat_map.png",
           measure::heatMap(readings.hidden, readings.sound, measure::HeatMap::signedLuminance, scale));
  fmt::print(
      "{0}/sound.png, mystery.png, heat_map.png (signed, {1:.3g} is full red)\nWhich is it? {2}\nlucerna lab mystery "
      "--seed {3} --answer NAME; lucerna lab museum describes them all.\n",
      options.folder, scale, fmt::join(mystery.candidates, ", "), options.seed);
  options.common.writeJson({{"seed", options.seed},
                            {"technique", mystery.technique},
                            {"candidates", mystery.candidates},
                            {"readings", rows}});
  return 0;
}

}  // namespace

void addMuseum(Subcommands& commands) {
  auto options = std::make_shared<MuseumOptions>();
  Command mysteryApp = commands.add("mystery", "A picture with one hidden deviation, to be found by instruments",
                                    [options] { return mystery(*options); });
  options->common.declare(mysteryApp);
  mysteryApp.addOption("--seed", options->seed, "determines the hidden deviation").required();
  mysteryApp.addOption("--answer", options->answer, "name of the deviation, to be graded");
  mysteryApp.addOption("-o,--output", options->folder, "folder of the pictures").showDefault();
  Command museumApp = commands.add(
      "museum", "One HTML page of every deviation: symptom, cause, formula, picture, the test that catches it",
      [options] { return museum(*options); });
  options->common.declare(museumApp);
  museumApp.addOption("-o,--output", options->html, "FILE.html").showDefault();
  museumApp.addOption("--room", options->room, "name of one deviation, whose room alone is shown");
  museumApp.addFlag("--small", options->small, "fewer samples, patches and cells: seconds instead of half a minute");
}

}  // namespace lucerna::demo
