// lucerna check, part probes: small uses of OpenGL that failed on some driver, or on which the techniques rely. Each
// one has a known answer.
#include "check/check.hpp"

#include "base/clock.hpp"
#include "base/statistics.hpp"
#include "gl/draw.hpp"
#include "gl/pass.hpp"
#include "gl/read_back.hpp"
#include "gl/time_query.hpp"

#include <fmt/core.h>

#include <array>
#include <bit>
#include <numeric>

namespace lucerna::demo::check {

namespace {

using gl::Barrier;

constexpr int kGroup = 64;

/// Zeros, uploaded: clearing is among what is tried.
gl::Buffer words(const std::string& name, std::size_t count) {
  const std::vector<std::uint32_t> zeros(count);
  return gl::Buffer(name, sizeof zeros[0] * count, zeros.data(), gl::Usage::dynamicCopy);
}

void dispatch(const std::string& name, std::uint32_t count, Barrier barrier) {
  const gl::ComputePass pass(name, barrier);
  pass.dispatch({static_cast<int>(count), 1, 1}, {kGroup, 1, 1});
}

/// Compute programs that fill words and count wrong ones.
struct Words {
  explicit Words(gl::ProgramLibrary& programs)
      : fillProgram(programs.loadCompute("check fill", "check/fill.comp")),
        countProgram(programs.loadCompute("check count words", "check/count_words.comp")),
        texelProgram(programs.loadCompute("check count texels", "check/count_texels.comp")),
        wrong(words("wrong", 1)),
        groups(words("groups", 3)) {}

  /// value + index.
  void fill(const gl::Buffer& target, std::uint32_t value, std::uint32_t count, std::uint32_t groupCount = 0) {
    fillProgram.use();
    fillProgram.set("value", value), fillProgram.set("count", count), fillProgram.set("groupCount", groupCount);
    target.bindStorage(0);
    groups.bindStorage(1);
    dispatch("fill", std::max(count, 3u), Barrier::storage | Barrier::command);
  }
  /// Counts what is not value + slope * index.
  void count(const gl::Buffer& source, std::uint32_t value, std::uint32_t slope, std::uint32_t count) {
    countProgram.use();
    countProgram.set("value", value), countProgram.set("slope", slope), countProgram.set("count", count);
    source.bindStorage(0);
    wrong.bindStorage(1);
    dispatch("count words", count, Barrier::storage);
  }
  void count(const gl::Texture& source, std::uint32_t value, std::uint32_t slope, std::uint32_t count) {
    texelProgram.use();
    texelProgram.set("value", value), texelProgram.set("slope", slope), texelProgram.set("count", count);
    source.bind(0);
    wrong.bindStorage(1);
    dispatch("count texels", count, Barrier::storage);
  }
  std::uint32_t takeWrong() {
    const auto count = wrong.readFirst<std::uint32_t>();
    constexpr std::uint32_t kZero = 0;
    wrong.upload(0, sizeof kZero, &kZero);
    return count;
  }

  const gl::Program &fillProgram, &countProgram, &texelProgram;
  gl::Buffer wrong, groups;
};

/// One variant of a probe: its wrong values.
void add(Finding& finding, const std::string& variant, std::uint32_t wrong) {
  finding.figures[variant] = wrong;
  finding.right = finding.right && wrong == 0;
  if (wrong > 0) finding.text += fmt::format("{}{}: {} wrong", finding.text.empty() ? "" : ", ", variant, wrong);
}

Finding ended(Finding finding, const std::string& exact) {
  if (finding.text.empty()) finding.text = exact;
  return finding;
}

/// Written by a shader, cleared by glClearBufferData, read by a shader: on NVIDIA some held what was there before.
Finding clears(const UnitInput& input) {
  Session session(input);
  Words tools(session.programs);
  Finding finding;
  constexpr std::uint32_t kRounds = 100;
  for (const std::uint32_t count : {16u, 4096u, 1u << 20}) {
    gl::Buffer buffer = words("cleared", count);
    for (const bool finished : {false, true}) {
      const std::string variant = fmt::format("{} words{}", count, finished ? ", finished after" : "");
      at(variant);
      for (std::uint32_t round = 0; round < kRounds; ++round) {
        tools.fill(buffer, 1000 + round, count);
        buffer.clear(round);
        if (finished) gl::finish();
        tools.count(buffer, round, 0, count);
      }
      add(finding, variant, tools.takeWrong());
    }
  }
  return ended(std::move(finding), "cleared buffers hold the new value");
}

/// Texels filled from a buffer that a shader has just written.
Finding texels(const UnitInput& input) {
  Session session(input);
  Words tools(session.programs);
  Finding finding;
  for (const int side : {4, 8, 32}) {
    const auto count = static_cast<std::uint32_t>(side * side * side);
    const gl::Buffer buffer = words("texels", count);
    gl::Texture volume("volume", gl::Format::r32ui, glm::ivec3(side));
    for (const bool finished : {false, true}) {
      const std::string variant = fmt::format("{} texels{}", count, finished ? ", finished before" : "");
      at(variant);
      for (std::uint32_t round = 0; round < 100; ++round) {
        tools.fill(buffer, 7 * round, count);
        if (finished) gl::finish();
        volume.copyFrom(buffer, 0);
        tools.count(volume, 7 * round, 1, count);
      }
      add(finding, variant, tools.takeWrong());
    }
  }
  return ended(std::move(finding), "texels hold what a shader wrote into their buffer");
}

/// A buffer that the program updates while shaders count in it, read back without waiting.
Finding uploads(const UnitInput& input) {
  Session session(input);
  const gl::Program& program = session.programs.loadCompute("check atomics", "check/atomics.comp");
  constexpr std::uint32_t kCount = 1000, kRounds = 200;
  gl::Buffer counter = words("counter", 2 + 1);
  gl::Texture image("counts", gl::Format::r32ui, glm::ivec3(1));
  gl::ReadBackRing ring("counts", sizeof(std::uint32_t));
  std::uint32_t round = 0, wrong = 0, fetched = 0;
  std::vector<std::uint32_t> expected;
  const auto take = [&](bool wait) {
    for (std::vector<GLuint> sample = ring.fetch(wait); !sample.empty(); sample = ring.fetch(wait))
      wrong += sample[0] != expected[fetched++];
  };
  for (; round < kRounds; ++round) {
    const std::array<std::uint32_t, 3> start{5 * round, 0, 0};
    counter.upload(0, sizeof start, start.data());
    program.use();
    program.set("count", kCount), program.set("residues", 1u);
    counter.bindStorage(0);
    image.bindImage(0, gl::Access::readWrite);
    dispatch("count", kCount, Barrier::storage | Barrier::image);
    // At most four samples wait in the ring.
    if (round - fetched >= 4) take(true);
    ring.copy(counter);
    expected.push_back(5 * round + kCount);
  }
  take(true);
  Finding finding;
  add(finding, "samples", wrong + (kRounds - fetched));
  return ended(std::move(finding), "counts follow the uploads");
}

/// A shader writes the number of groups of the next dispatch.
Finding indirect(const UnitInput& input) {
  Session session(input);
  Words tools(session.programs);
  const gl::Program& program = session.programs.loadCompute("check atomics", "check/atomics.comp");
  const gl::Buffer scratch = words("scratch", 3);
  gl::Texture image("counts", gl::Format::r32ui, glm::ivec3(1));
  std::uint32_t wrong = 0;
  for (const std::uint32_t groups : {1u, 0u, 7u, 1024u, 3u, 65535u, 2u}) {
    at(fmt::format("{} groups", groups));
    gl::Buffer counter = words("counter", 2 + 1);
    tools.fill(scratch, 0, 3, groups);
    program.use();
    program.set("count", ~0u), program.set("residues", 1u);
    counter.bindStorage(0);
    image.bindImage(0, gl::Access::readWrite);
    {
      const gl::ComputePass pass("indirect", Barrier::storage | Barrier::image);
      pass.dispatchIndirect(tools.groups);
    }
    wrong += counter.readFirst<std::uint32_t>() != kGroup * groups;
  }
  Finding finding;
  add(finding, "dispatches", wrong);
  return ended(std::move(finding), "indirect dispatches have the groups that a shader counted");
}

/// Millions of atomic additions to one word, to many, and to texels.
Finding atomics(const UnitInput& input) {
  Session session(input);
  Words tools(session.programs);
  const gl::Program& program = session.programs.loadCompute("check atomics", "check/atomics.comp");
  Finding finding;
  for (const std::uint32_t residues : {1u, 64u, 1024u}) {
    constexpr std::uint32_t kCount = 1 << 20;
    at(fmt::format("{} residues", residues));
    gl::Buffer counter = words("counter", 2 + residues);
    gl::Texture image("counts", gl::Format::r32ui, glm::ivec3(32, 32, 1));
    const std::array<const gl::Texture*, 1> images{&image};
    gl::clearToZero(images, session.context.capabilities().clearTexture);
    program.use();
    program.set("count", kCount), program.set("residues", residues);
    counter.bindStorage(0);
    image.bindImage(0, gl::Access::readWrite);
    const auto start = Clock::now();
    dispatch("atomics", kCount, Barrier::image | Barrier::textureFetch);
    gl::finish();
    finding.figures[fmt::format("seconds of {} residues", residues)] = secondsSince(start);
    const auto counts = counter.read<std::uint32_t>();
    std::uint32_t wrong = counts[0] != kCount || counts[1] != kCount - 1;
    for (std::uint32_t i = 0; i < residues; ++i) wrong += counts[2 + i] != kCount / residues;
    tools.count(image, kCount / residues, 0, residues);
    wrong += tools.takeWrong();
    add(finding, fmt::format("{} residues", residues), wrong);
  }
  return ended(std::move(finding), "atomic counts are exact");
}

/// Steps, each of which reads what the step before wrote: words count, and move half way round.
Finding feedback(const UnitInput& input) {
  Session session(input);
  Words tools(session.programs);
  Finding finding;
  constexpr std::uint32_t kSteps = 1024, kCount = 2 * kSteps;
  std::vector<std::uint32_t> numbers(kCount);
  std::iota(numbers.begin(), numbers.end(), 0u);
  // Storage blocks.
  const gl::Program& step = session.programs.loadCompute("check step words", "check/step_words.comp");
  at("steps of storage blocks");
  std::array<gl::Buffer, 2> buffers{gl::Buffer("even", 4 * kCount, numbers.data(), gl::Usage::dynamicCopy),
                                    words("odd", kCount)};
  for (std::uint32_t i = 0; i < kSteps; ++i) {
    step.use();
    step.set("count", kCount);
    buffers[i % 2].bindStorage(0);
    buffers[(i + 1) % 2].bindStorage(1);
    dispatch("step", kCount, Barrier::storage);
  }
  tools.count(buffers[0], kCount, 1, kSteps);
  add(finding, "storage blocks", tools.takeWrong());
  // Images, read as textures.
  const gl::Program& texelStep = session.programs.loadCompute("check step texels", "check/step_texels.comp");
  at("steps of images");
  std::array<gl::Texture, 2> volumes;
  for (gl::Texture& volume : volumes) {
    volume = gl::Texture("volume", gl::Format::r32ui, glm::ivec3(kCount, 1, 1));
    volume.upload(gl::Texels::redInt, numbers.data());
  }
  for (std::uint32_t i = 0; i < kSteps; ++i) {
    texelStep.use();
    volumes[i % 2].bind(0);
    volumes[(i + 1) % 2].bindImage(0, gl::Access::write);
    const gl::ComputePass pass("step", Barrier::textureFetch | Barrier::image);
    pass.dispatch({kCount, 1, 1}, {kGroup, 1, 1});
  }
  tools.count(volumes[0], kCount, 1, kSteps);
  add(finding, "images", tools.takeWrong());
  return ended(std::move(finding), "every step sees the one before");
}

/// Triangles drawn into the layers of a volume, added by blending.
Finding layers(const UnitInput& input) {
  Session session(input);
  constexpr int kSide = 32, kTimes = 5;
  const gl::Program& program =
      session.programs.loadRaster("check layers", "check/layers.vert", "check/layers.frag", {}, "check/layers.geom");
  const gl::Texture volume("layers", gl::Format::rgba32f, glm::ivec3(kSide));
  const std::array<const gl::Texture*, 1> targets{&volume};
  const gl::Framebuffer target("layers", targets);
  const gl::VertexArray none("none");
  {
    const gl::RasterPass pass("layers", target, {.blend = gl::Blend::add});
    pass.clearColor(0, glm::vec4(0.0f));
    program.use();
    program.set("layers", kSide);
    none.bind();
    gl::drawTriangles(3, kSide * kTimes);
  }
  std::uint32_t wrong = 0;
  const std::vector<glm::vec4> texels = volume.readRgba();
  for (int z = 0; z < kSide; ++z)
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x)
        wrong += texels[static_cast<std::size_t>((z * kSide + y) * kSide + x)] !=
                 static_cast<float>(kTimes) * glm::vec4(1.0f, z, x, y);
  Finding finding;
  add(finding, "texels", wrong);
  return ended(std::move(finding), "every layer has its triangles, added exactly");
}

/// What OpenGL leaves open; says, does not judge.
Finding arithmetic(const UnitInput& input) {
  Session session(input);
  const gl::Program& program = session.programs.loadCompute("check arithmetic", "check/arithmetic.comp");
  const gl::Buffer values = words("values", 10);
  program.use();
  program.set("zero", 0.0f), program.set("one", 1.0f), program.set("big", 1e20f);
  values.bindStorage(0);
  dispatch("arithmetic", 1, Barrier::none);
  const auto v = values.read<std::int32_t>();
  const auto real = [&](std::size_t i) { return std::bit_cast<float>(v[i]); };
  Finding finding;
  finding.figures = {{"int(1e20)", v[0]},
                     {"int(-1e20)", v[1]},
                     {"int(nan)", v[2]},
                     {"uint(1e20)", static_cast<std::uint32_t>(v[3])},
                     {"min(nan, 1)", fmt::format("{:g}", real(4))},
                     {"max(1, nan)", fmt::format("{:g}", real(5))},
                     {"isnan(nan)", v[6]},
                     {"isinf(inf)", v[7]},
                     {"atan, largest error", real(8)},
                     {"angleOf, largest error", real(9)}};
  finding.text = fmt::format("int(1e20) {}, int(nan) {}, min(nan, 1) {:g}, max(1, nan) {:g}, atan off by {:.1e}", v[0],
                             v[2], real(4), real(5), real(8));
  return finding;
}

/// Timer queries against the wall clock around them: one that is longer, or 0, measures something else.
Finding timers(const UnitInput& input) {
  Session session(input);
  const gl::Program& program = session.programs.loadCompute("check atomics", "check/atomics.comp");
  constexpr std::uint32_t kCount = 1 << 18, kRounds = 20;
  const gl::Buffer counter = words("counter", 2 + 1);
  const gl::Texture image("counts", gl::Format::r32ui, glm::ivec3(1));
  gl::TimeQuery timer(true);
  for (std::uint32_t i = 0; i < kRounds; ++i) {
    const gl::TimeQuery::Scope stage(timer, "atomics");
    program.use();
    program.set("count", kCount), program.set("residues", 1u);
    counter.bindStorage(0);
    image.bindImage(0, gl::Access::readWrite);
    dispatch("atomics", kCount, Barrier::storage | Barrier::image);
  }
  timer.drain();
  timer.collect();
  const gl::StageStatistics s = timer.statistics().front();
  Finding finding;
  finding.figures = {{"query_ms", s.queryMedianMs}, {"wall_ms", s.wallMedianMs}, {"queries", s.count}};
  finding.text = fmt::format("queries {:.3f} ms, wall clock {:.3f} ms", s.queryMedianMs, s.wallMedianMs);
  // On a software renderer stage times come from the wall clock: queries only inform.
  if (!session.context.capabilities().softwareRenderer)
    finding.right = s.queryMedianMs > 0.0 && s.queryMedianMs < 1.05 * s.wallMedianMs;
  return finding;
}

}  // namespace

std::vector<Unit> probeUnits() {
  std::vector<Unit> units;
  const auto add = [&](const char* name, Finding (*run)(const UnitInput&)) {
    units.push_back({"probes", name, 20.0, run});
  };
  add("clears", clears);
  add("texels", texels);
  add("uploads", uploads);
  add("indirect", indirect);
  add("atomics", atomics);
  add("feedback", feedback);
  add("layers", layers);
  add("timers", timers);
  add("arithmetic", arithmetic);
  return units;
}

}  // namespace lucerna::demo::check
