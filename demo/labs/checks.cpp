// The checks of a lab: probes run on the GPU, statistics, and recognition of the most likely mistake.
#include "base/clock.hpp"
#include "labs/lab.hpp"

#include "base/data.hpp"
#include "base/error.hpp"
#include "base/files.hpp"
#include "base/hash.hpp"
#include "gl/context.hpp"
#include "gl/objects.hpp"
#include "gl/pass.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <regex>
#include <sstream>

namespace lucerna::demo::labs {

namespace fs = std::filesystem;

namespace {

std::uint64_t hashOf(const std::string& text) {
  // FNV's low bits are weak; splitmix64 mixes them.
  return Random(Hash::of(text.data(), text.size())).word();
}

bool isFinite(const glm::vec4& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z) && std::isfinite(v.w);
}

std::string vectorText(const glm::dvec4& v) {
  // Omit components after the last nonzero one.
  std::string text = fmt::format("{:.6g}", v.x);
  if (v == glm::dvec4(v.x)) return text;  // a scalar
  const int last = v.w != 0.0 ? 3 : v.z != 0.0 ? 2 : v.y != 0.0 ? 1 : 0;
  for (int c = 1; c <= last; ++c) text += fmt::format(" {:.6g}", v[c]);
  return text;
}

std::string pointText(Point point) {
  std::string text;
  for (const glm::vec4& v : point) text += (text.empty() ? "" : "; ") + vectorText(v);
  return text;
}

/// A ratio caused by a lost or doubled constant.
std::optional<Mistake> factorMistake(double ratio) {
  constexpr double kPi = std::numbers::pi;
  struct Named {
    double value;
    const char* name;
  };
  const std::array named{Named{kPi, "pi"},         Named{1.0 / kPi, "1 / pi"},
                         Named{2.0, "2"},          Named{0.5, "1 / 2"},
                         Named{4.0, "4"},          Named{0.25, "1 / 4"},
                         Named{2.0 * kPi, "2 pi"}, Named{0.5 / kPi, "1 / (2 pi)"},
                         Named{4.0 * kPi, "4 pi"}, Named{0.25 / kPi, "1 / (4 pi)"},
                         Named{kPi * kPi, "pi^2"}, Named{1.0 / (kPi * kPi), "1 / pi^2"}};
  for (const Named& f : named)
    for (const double sign : {1.0, -1.0})
      if (std::abs(ratio / (sign * f.value) - 1.0) < 2e-3)
        return Mistake{"factor",
                       fmt::format("everything is {}{} times what it should be: a constant is missing or counted twice",
                                   sign < 0.0 ? "-" : "", f.name)};
  if (std::abs(ratio + 1.0) < 2e-3) return Mistake{"sign", "everything has the wrong sign"};
  return std::nullopt;
}

const Mistake kNan{"nan",
                   "a result is not a finite number: a division by zero, the square root or logarithm of a negative "
                   "number, or a variable without a value"};
const Mistake kOther{"other", "no typical mistake fits; compare the worst point by hand"};

}  // namespace

const char* nameOf(Verdict verdict) {
  switch (verdict) {
    case Verdict::passed: return "passed";
    case Verdict::wrong: return "wrong";
    case Verdict::notDone: return "not done";
    case Verdict::waiting: return "waiting";
  }
  return "";
}

// ------------------------------------------------------------------------------------------------------------ the
// hand-in's files

namespace {

/// Replaces comments by blanks, so that lines keep their numbers.
std::string withoutComments(const std::string& text) {
  std::string result = text;
  bool inLine = false, inBlock = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (inLine && text[i] == '\n') inLine = false;
    if (!inLine && !inBlock && text.compare(i, 2, "//") == 0) inLine = true;
    if (!inLine && !inBlock && text.compare(i, 2, "/*") == 0) inBlock = true;
    if ((inLine || inBlock) && text[i] != '\n') result[i] = ' ';
    if (inBlock && i > 0 && text.compare(i - 1, 2, "*/") == 0) inBlock = false;
  }
  return result;
}

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

}  // namespace

std::map<std::string, std::string> parseAnswers(const std::string& text) {
  std::map<std::string, std::string> answers;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line) && !line.starts_with("---");) {
    if (const auto comment = line.find('#'); comment != std::string::npos) line.resize(comment);
    if (const auto equals = line.find('='); equals != std::string::npos)
      answers[trimmed(line.substr(0, equals))] = trimmed(line.substr(equals + 1));
  }
  return answers;
}

std::vector<int> tasksNotDone(const std::string& text) {
  std::vector<int> tasks;
  static const std::regex kMark(R"(\bNOT_DONE\s*\(\s*(\d+)\s*\))");
  const std::string code = withoutComments(text);
  for (auto it = std::sregex_iterator(code.begin(), code.end(), kMark); it != std::sregex_iterator(); ++it)
    tasks.push_back(std::stoi((*it)[1]));
  return tasks;
}

std::string forbiddenLine(const std::string& text, const std::string& name) {
  static const std::regex kForbidden(
      R"(#|\b(layout|buffer|uniform|shared|imageStore|imageLoad|discard|gl_\w+|lab[A-Z]\w*)\b)");
  std::istringstream stream(withoutComments(text));
  int number = 1;
  std::smatch match;
  for (std::string line; std::getline(stream, line); ++number)
    if (std::regex_search(line, match, kForbidden))
      return fmt::format("{}:{}: '{}' has no place here: this file may only contain functions and constants", name,
                         number, match.str());
  return "";
}

// ------------------------------------------------------------------------------------------------------------ the GPU

Probes::Probes(const Lab& lab, const HandIn& handIn) {
  static int count = 0;
  root_ = fs::temp_directory_path() / fmt::format("lucerna-lab-{}-{}", getpid(), ++count);
  fs::create_directories(root_ / "lab");
  for (const auto& entry : fs::directory_iterator(dataFolder() / "shaders"))
    fs::create_symlink(entry.path(), root_ / entry.path().filename());
  for (const char* file : {"kernel.comp", "common.glsl"}) fs::create_symlink(labsFolder() / file, root_ / "lab" / file);
  fs::create_symlink(labsFolder() / lab.folder / "probe.glsl", root_ / "lab/probe.glsl");
  writeFileAtomically(root_ / "lab/tasks.glsl", handIn.tasks);
  programs_ = std::make_unique<gl::ProgramLibrary>(root_);
}
Probes::~Probes() {
  std::error_code error;
  fs::remove_all(root_, error);
}
const gl::Program& Probes::load(const Lab& lab, int probe) {
  return programs_->loadCompute(fmt::format("lab {} probe {}", lab.number, probe), "lab/kernel.comp",
                                {{"PROBE", probe}});
}

Checks::Checks(const Lab& lab, const HandIn& handIn, std::uint64_t nonce, Report& report, Probes& probes)
    : lab_(lab),
      handIn_(handIn),
      report_(report),
      random_(nonce),
      notDone_(tasksNotDone(handIn.tasks)),
      noise_(static_cast<std::uint32_t>(Random(nonce).word())),
      probes_(probes) {}

std::vector<glm::vec4> Checks::run(int probe, std::span<const glm::vec4> inputs, int stride, int count, int width) {
  const gl::Program& program = probes_.load(lab_, probe);
  const gl::Buffer points("lab inputs", std::max<std::size_t>(inputs.size_bytes(), 16),
                          inputs.empty() ? nullptr : inputs.data(), gl::Usage::staticDraw);
  const gl::Buffer results("lab outputs", static_cast<std::size_t>(count) * sizeof(glm::vec4), nullptr,
                           gl::Usage::dynamicCopy);
  points.bindStorage(0);
  results.bindStorage(1);
  program.use();
  program.set("labCount", static_cast<unsigned>(count));
  program.set("labStride", static_cast<unsigned>(stride));
  program.set("labWidth", static_cast<unsigned>(width));
  program.set("labNoise", noise_ = static_cast<std::uint32_t>(Random(noise_ + 1u).word()));
  gl::ComputePass("lab probe").dispatch({count, 1, 1}, {64, 1, 1});
  return results.read<glm::vec4>();
}

double Checks::parameter(const std::string& name, double least, double most, int digits) const {
  const double scale = std::pow(10.0, digits);
  return std::round(Random(hashOf(handIn_.seed + "/" + std::to_string(lab_.number) + "/" + name)).uniform(least, most) *
                    scale) /
         scale;
}

double Checks::yours(const std::string& name, double least, double most, int digits) {
  const double value = parameter(name, least, most, digits);
  report_.yours.emplace_back(name, fmt::format("{:g}", value));
  figure(name, value);
  return value;
}

bool Checks::add(CheckResult result) {
  result.task = task_;
  report_.checks.push_back(std::move(result));
  return report_.checks.back().verdict == Verdict::passed;
}

bool Checks::task(int number) {
  task_ = number;
  const auto found =
      std::find_if(lab_.tasks.begin(), lab_.tasks.end(), [&](const Task& t) { return t.number == number; });
  CHECK(found != lab_.tasks.end(), "lab {}, task {}", lab_.number, number);
  if (std::find(notDone_.begin(), notDone_.end(), number) != notDone_.end()) {
    add({.name = found->function,
         .verdict = Verdict::notDone,
         .mistake = {"not-done", fmt::format("task {} not done", number)}});
    return false;
  }
  for (const int needed : found->needs)
    if (report_.verdictOf(needed) != Verdict::passed) {
      add({.name = found->function,
           .verdict = Verdict::waiting,
           .mistake = {"waiting", fmt::format("waits for task {}", needed)}});
      return false;
    }
  return true;
}

// ------------------------------------------------------------------------------------------------------------ the
// tests

bool Checks::againstReference(const std::string& name, const Reference& expected) {
  const auto stride = static_cast<std::size_t>(expected.stride), count = static_cast<std::size_t>(expected.points);
  std::vector<glm::vec4> points(stride * count, glm::vec4(0.0f));
  const auto pointOf = [&](std::size_t i) { return Point(points).subspan(i * stride, stride); };
  std::vector<glm::dvec4> reference(count);
  double square = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    expected.draw(random_, std::span(points).subspan(i * stride, stride));
    reference[i] = expected.reference(pointOf(i));
    square += glm::dot(reference[i], reference[i]);
  }
  const double rms = std::sqrt(square / static_cast<double>(count)), scale = 0.01 * rms;
  // Where terms cancel, the result carries the rounding of the terms: eight units in the last place of a float of
  // typical size.
  const double rounding = 0x1p-21 * rms;
  const std::vector<glm::vec4> measured = run(expected.probe, points, expected.stride, expected.points);

  // Distance in units of the tolerance; the worst point, and the number of points that a wrong formula would explain.
  const auto distance = [&](std::size_t i, const glm::dvec4& value) {
    return glm::length(glm::dvec4(measured[i]) - value) /
           (expected.tolerance * (glm::length(value) + scale) + rounding);
  };
  std::size_t worst = 0, agreeing = 0;
  bool finite = true;
  for (std::size_t i = 0; i < count && finite; ++i) {
    finite = isFinite(measured[i]);
    if (!finite || distance(i, reference[i]) > distance(worst, reference[worst])) worst = i;
    if (finite && distance(i, reference[i]) <= 1.0) ++agreeing;
  }
  CheckResult result{.name = name, .expected = vectorText(reference[worst]), .measured = vectorText(measured[worst])};
  if (finite && agreeing == count) {
    result.verdict = Verdict::passed;
    result.sigma = fmt::format("{} points, worst {:.2g} of the tolerance", count, distance(worst, reference[worst]));
    return add(result);
  }
  result.sigma =
      fmt::format("{} of {} points agree; the worst has inputs {}", agreeing, count, pointText(pointOf(worst)));
  const auto diagnose = [&]() -> Mistake {
    if (!finite) return kNan;
    const Reference::Wrong* best = nullptr;
    std::size_t most = 0;
    for (const Reference::Wrong& wrong : expected.mistakes) {
      std::size_t explained = 0;
      for (std::size_t i = 0; i < count; ++i)
        if (distance(i, wrong.value(pointOf(i))) <= 3.0) ++explained;
      if (explained > most) most = explained, best = &wrong;
    }
    if (best && most >= count - count / 200) return best->mistake;
    glm::dvec4 first(measured[0]);
    double spread = 0.0, cross = 0.0, length = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      spread = std::max(spread, glm::length(glm::dvec4(measured[i]) - first));
      cross += glm::dot(glm::dvec4(measured[i]), reference[i]);
      length = std::max(length, glm::length(glm::dvec4(measured[i])));
    }
    if (length == 0.0) return {"zero", "the result is zero everywhere"};
    if (spread == 0.0) return {"constant", "the result does not depend on what the function is given"};
    const double ratio = cross / square;
    bool proportional = true;
    for (std::size_t i = 0; i < count && proportional; ++i)
      proportional = glm::length(glm::dvec4(measured[i]) - ratio * reference[i]) <=
                     10.0 * expected.tolerance * std::abs(ratio) * (glm::length(reference[i]) + scale);
    if (proportional)
      return factorMistake(ratio).value_or(
          Mistake{"factor", fmt::format("everything is {:.6g} times what it should be: a constant is wrong", ratio)});
    if (best && most > agreeing && most >= count / 2) return best->mistake;
    return kOther;
  };
  result.mistake = diagnose();
  return add(result);
}

bool Checks::mean(const std::string& name, const Mean& test) {
  CHECK(++tests_ <= kMostTests, "more tests than their thresholds are made for");
  const std::vector<glm::vec4> values = run(test.probe, test.inputs, 0, test.invocations);
  const double count = static_cast<double>(test.invocations);
  double sum = 0.0, square = 0.0;
  bool finite = true;
  for (const glm::vec4& v : values) {
    finite = finite && isFinite(v);
    sum += v.x;
  }
  const double mean = sum / count;
  for (const glm::vec4& v : values) square += (v.x - mean) * (v.x - mean);
  const double error = std::sqrt(square / (count - 1.0) / count);
  // Allowed rounding is subtracted before the test; without noise it is the only allowed difference.
  const auto tail = [&](double expected) {
    const double off = std::max(0.0, std::abs(mean - expected) - kFirmness * (std::abs(expected) + std::abs(mean)));
    return error > 0.0 ? studentTail(off / error, count - 1.0) : off > 0.0 ? 0.0 : 1.0;
  };
  CheckResult result{.name = name,
                     .expected = fmt::format("{:.6g}", test.expected),
                     .measured = finite ? fmt::format("{:.6g} +- {:.2g}", mean, error) : "not a number"};
  if (finite) {
    result.pValue = tail(test.expected);
    // An estimate without noise deviates by many times its own deviation through rounding alone.
    const double off = std::abs(mean - test.expected),
                 rounding = kFirmness * (std::abs(test.expected) + std::abs(mean));
    result.sigma = off <= rounding ? "off by a float's rounding at most"
                   : error > 0.0   ? fmt::format("{:.1f} sigma", off / error)
                                   : fmt::format("no noise, off by {:.2g}", off);
    if (result.pValue >= kFalseAlarm / kMostTests) {
      result.verdict = Verdict::passed;
      return add(result);
    }
  }
  result.mistake = kOther;
  double nearest = 1e300;
  for (const Mean::Wrong& wrong : test.mistakes)
    if (finite && tail(wrong.value) >= kFalseAlarm / kMostTests && std::abs(mean - wrong.value) < nearest)
      nearest = std::abs(mean - wrong.value), result.mistake = wrong.mistake;
  if (!finite) result.mistake = kNan;
  else if (nearest == 1e300 && mean == 0.0 && error == 0.0) result.mistake = {"zero", "the result is zero everywhere"};
  else if (nearest == 1e300) result.mistake = factorMistake(mean / test.expected).value_or(kOther);
  return add(result);
}

bool Checks::chiSquare(const std::string& name, const ChiSquare& test) {
  CHECK(++tests_ <= kMostTests, "more tests than their thresholds are made for");
  const std::vector<glm::vec4> samples = run(test.probe, test.inputs, 0, test.samples);
  const std::size_t bins = test.shares.size();
  std::vector<double> counts(bins + 1, 0.0);  // the last: outside all bins
  bool finite = true;
  for (const glm::vec4& s : samples) {
    finite = finite && isFinite(s);
    const int bin = isFinite(s) ? test.bin(s) : -1;
    counts[bin < 0 || bin >= static_cast<int>(bins) ? bins : static_cast<std::size_t>(bin)] += 1.0;
  }
  // An event that a hypothesis excludes rules it out if it is the reference; a mistake may cause a share of such events
  // besides.
  const auto statistic = [&](const std::vector<double>& shares, double least) {
    double sum = 0.0;
    for (std::size_t b = 0; b <= bins; ++b) {
      const double expected = (b < shares.size() ? shares[b] : 0.0) * static_cast<double>(test.samples);
      if (expected == 0.0 && least == 0.0) sum += counts[b] > 0.0 ? 1e9 : 0.0;
      else if (expected > 0.0 || counts[b] > 0.0)
        sum += (counts[b] - expected) * (counts[b] - expected) /
               std::max(expected, least * static_cast<double>(test.samples));
    }
    return sum;
  };
  const double degrees = static_cast<double>(bins) - 1.0, chi = statistic(test.shares, 0.0);
  CheckResult result{.name = name,
                     .expected = fmt::format("chi-square {:.0f} +- {:.0f}", degrees, std::sqrt(2.0 * degrees)),
                     .measured = chi >= 1e9
                                     ? fmt::format("{:.0f} of {} samples where none can be", counts[bins], test.samples)
                                     : fmt::format("{:.1f}", chi)};
  result.pValue = finite ? chiSquareTail(chi, degrees) : 0.0;
  result.sigma = fmt::format("{:.1f} sigma", (chi - degrees) / std::sqrt(2.0 * degrees));
  if (chi >= 1e9) result.sigma = "impossible";
  if (finite && result.pValue >= kFalseAlarm / kMostTests) {
    result.verdict = Verdict::passed;
    return add(result);
  }
  result.mistake = finite ? kOther : kNan;
  double least = 0.25 * statistic(test.shares, 1e-3);
  for (const ChiSquare::Wrong& wrong : test.mistakes)
    if (const double other = statistic(wrong.shares, 1e-3); finite && other < least)
      least = other, result.mistake = wrong.mistake;
  return add(result);
}

bool Checks::picture(const std::string& name, const Picture& test) {
  return picture(name, test, run(test.probe, test.inputs, 0, test.size.x * test.size.y, test.size.x));
}

bool Checks::picture(const std::string& name, const Picture& test, const std::vector<glm::vec4>& pixels) {
  CHECK(++tests_ <= kMostTests, "more tests than their thresholds are made for");
  constexpr int kTile = 8;
  PictureResult shown{name, test.caption, Image(test.size.x, test.size.y), Image(test.size.x, test.size.y)};
  bool finite = true, noisy = false;
  double squareOff = 0.0, square = 0.0, brightest = 0.0;
  for (int y = 0; y < test.size.y; ++y)
    for (int x = 0; x < test.size.x; ++x) {
      const glm::vec4& p = pixels[static_cast<std::size_t>(y * test.size.x + x)];
      const glm::dvec3 reference = test.reference({x, y});
      finite = finite && isFinite(p);
      noisy = noisy || p.w > 0.0f;
      shown.mine.at(x, y) = glm::vec3(p);
      shown.reference.at(x, y) = glm::vec3(reference);
      brightest = std::max({brightest, reference.x, reference.y, reference.z});
      const glm::dvec3 off = glm::dvec3(p) - reference;
      squareOff += glm::dot(off, off);
      square += glm::dot(reference, reference);
    }
  if (brightest > 0.0) shown.exposure = static_cast<float>(1.0 / brightest);
  const double rms = std::sqrt(square / (3.0 * test.size.x * test.size.y));
  CheckResult result{.name = name,
                     .expected = fmt::format("relative L2 {}", noisy ? "of the noise alone" : "below 0.1 %"),
                     .measured = fmt::format("relative L2 {:.3g} %", 100.0 * std::sqrt(squareOff / square))};
  if (noisy) {
    // Tiles: compare the mean difference with its standard error.
    const int across = test.size.x / kTile, down = test.size.y / kTile;
    double worst = 0.0, least = 1.0;
    for (int ty = 0; ty < down; ++ty)
      for (int tx = 0; tx < across; ++tx) {
        double off = 0.0, variance = 0.0, size = 0.0;
        for (int k = 0; k < kTile * kTile; ++k) {
          const int x = tx * kTile + k % kTile, y = ty * kTile + k / kTile;
          const glm::dvec3 a(shown.mine.at(x, y)), b(shown.reference.at(x, y));
          off += (a.x + a.y + a.z - b.x - b.y - b.z) / 3.0;
          size += (b.x + b.y + b.z) / 3.0;
          variance += pixels[static_cast<std::size_t>(y * test.size.x + x)].w;
        }
        const double beyond = std::max(0.0, std::abs(off) - 2.0 * kFirmness * size), error = std::sqrt(variance);
        const double p = error > 0.0 ? studentTail(beyond / error, kTile * kTile * 8.0) : beyond > 0.0 ? 0.0 : 1.0;
        if (p < least) least = p;
        worst = std::max(worst, error > 0.0 ? std::abs(off) / error : 0.0);
      }
    result.pValue = std::min(1.0, least * across * down);
    result.sigma = fmt::format("worst of {} tiles {:.1f} sigma", across * down, worst);
    result.verdict = finite && result.pValue >= kFalseAlarm / kMostTests ? Verdict::passed : Verdict::wrong;
  } else {
    double worst = 0.0;
    for (std::size_t i = 0; i < pixels.size(); ++i)
      worst = std::max(worst, glm::length(glm::dvec3(shown.mine.pixels[i]) - glm::dvec3(shown.reference.pixels[i])) /
                                  (glm::length(glm::dvec3(shown.reference.pixels[i])) + rms));
    result.sigma = fmt::format("worst pixel off by {:.3g} %", 100.0 * worst);
    result.verdict = finite && worst <= 1e-3 ? Verdict::passed : Verdict::wrong;
  }
  if (result.verdict == Verdict::wrong) {
    result.mistake = finite ? kOther : kNan;
    double least = 0.1 * squareOff;  // a wrong picture must explain nine tenths of the difference
    for (const Picture::Wrong& wrong : test.mistakes) {
      double other = 0.0;
      for (int y = 0; y < test.size.y; ++y)
        for (int x = 0; x < test.size.x; ++x) {
          const glm::dvec3 off = glm::dvec3(shown.mine.at(x, y)) - wrong.value({x, y});
          other += glm::dot(off, off);
        }
      if (finite && other < least) least = other, result.mistake = wrong.mistake;
    }
  }
  report_.pictures.push_back(std::move(shown));
  return add(result);
}

void Checks::answer(const std::string& name, double expected, double tolerance,
                    const std::vector<Mean::Wrong>& mistakes) {
  task_ = 0;
  report_.expectedAnswers.emplace_back(name, expected);
  const auto found = handIn_.answers.find(name);
  CheckResult result{.name = "question " + name};
  if (found == handIn_.answers.end() || found->second.empty()) {
    result.verdict = Verdict::notDone;
    result.mistake = {"not-done", fmt::format("answers.txt: {} has no number yet", name)};
    add(result);
    return;
  }
  char* end = nullptr;
  const double value = std::strtod(found->second.c_str(), &end);
  result.measured = found->second;
  const std::string near = tolerance > 0.0 ? fmt::format("within {:.2g} %", 100.0 * tolerance) : "exactly";
  result.sigma = fmt::format("yours is {}; a number counts {}", found->second, near);
  const auto isNear = [&](double wanted) { return std::abs(value - wanted) <= tolerance * std::abs(wanted) + 1e-12; };
  if (!end || *end != '\0' || end == found->second.c_str() || !std::isfinite(value))
    result.mistake = {
        "nan", fmt::format("answers.txt: {} is not a number; write it with a decimal point, such as 0.25", name)};
  else if (isNear(expected)) result.verdict = Verdict::passed, result.sigma = near;
  else {
    // Do not reveal the correct number, which is the answer.
    result.mistake = {"other", "not the number for this seed; README.md says what it follows from"};
    if (const auto factor = factorMistake(value / expected))
      result.mistake = {factor->id, "right but for a constant factor"};
    for (const Mean::Wrong& wrong : mistakes)
      if (isNear(wrong.value)) result.mistake = wrong.mistake;
  }
  add(result);
}

void Checks::figure(const std::string& name, double value, int digits) {
  report_.figures.emplace_back(name, fmt::format("{:.{}g}", value, digits));
}

// ------------------------------------------------------------------------------------------------------------ a whole
// check

Verdict Report::verdictOf(int task) const {
  Verdict verdict = Verdict::waiting;
  for (const CheckResult& check : checks) {
    if (check.task != task) continue;
    if (check.verdict != Verdict::passed) return check.verdict;
    verdict = Verdict::passed;
  }
  return verdict;
}

double Report::score(const Lab& lab) const {
  double score = 0.0;
  for (const Task& task : lab.tasks)
    if (verdictOf(task.number) == Verdict::passed) score += task.points;
  int questions = 0, right = 0;
  for (const CheckResult& check : checks)
    if (check.task == 0) ++questions, right += check.verdict == Verdict::passed ? 1 : 0;
  return questions > 0 ? score + lab.answerPoints * static_cast<double>(right) / questions : score;
}

bool Report::allPassed() const {
  return compileError.empty() && !checks.empty() &&
         std::all_of(checks.begin(), checks.end(), [](const CheckResult& c) { return c.verdict == Verdict::passed; });
}

Report runChecks(const Lab& lab, const HandIn& handIn, std::uint64_t nonce) {
  Probes probes(lab, handIn);
  return runChecks(lab, handIn, nonce, probes);
}

Report runChecks(const Lab& lab, const HandIn& handIn, std::uint64_t nonce, Probes& probes) {
  const auto start = Clock::now();
  Report report;
  report.seed = handIn.seed;
  report.nonce = nonce;
  report.compileError = forbiddenLine(handIn.tasks, handIn.tasksName);
  if (report.compileError.empty()) {
    try {
      Checks checks(lab, handIn, nonce, report, probes);
      lab.check(checks);
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::badInput) throw;
      // The driver's log names the copy; the student knows the file by its original name.
      std::string message = error.what();
      const auto replaceAll = [&](const std::string& from, const std::string& to) {
        for (std::size_t at = 0; (at = message.find(from, at)) != std::string::npos; at += to.size())
          message.replace(at, from.size(), to);
      };
      replaceAll("shaders/lab/tasks.glsl", handIn.tasksName);
      if (const auto end = message.find('\n'); message.starts_with("program lab ") && end != std::string::npos)
        message.replace(0, end, handIn.tasksName + " does not compile:");
      if (message.find("shaders/lab/probe.glsl") != std::string::npos)
        message +=
            "\nA function of " + handIn.tasksName + " is missing, or its signature differs from that in README.md.";
      report.compileError = message;
    }
  }
  report.seconds = secondsSince(start);
  return report;
}

}  // namespace lucerna::demo::labs
