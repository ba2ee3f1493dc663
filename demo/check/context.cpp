// lucerna check, part context: the driver's identity and limits.
#include "check/check.hpp"

#include "base/clock.hpp"

#include <fmt/core.h>

namespace lucerna::demo::check {

namespace {

Finding identify(const UnitInput& input) {
  const auto start = Clock::now();
  Session session(input);
  const gl::Capabilities& c = session.context.capabilities();
  Finding finding;
  finding.text = fmt::format("OpenGL {} in {:.2f} s, {} of {} probed extensions", c.version, secondsSince(start),
                             std::ranges::count_if(c.probedExtensions(), [](const auto& e) { return e.second; }),
                             c.probedExtensions().size());
  finding.figures = {{"renderer", c.renderer},
                     {"vendor", c.vendor},
                     {"opengl", c.version},
                     {"glsl", c.shadingLanguage},
                     {"host", nameOf(session.host->kind())},
                     {"software", c.softwareRenderer}};
  for (const auto& [name, value] : c.limits()) finding.figures["limits"][name] = value;
  for (const auto& [name, there] : c.probedExtensions()) finding.figures["extensions"][name] = there;
  return finding;
}

}  // namespace

std::vector<Unit> contextUnits() { return {{"context", "limits", 60.0, identify}}; }

}  // namespace lucerna::demo::check
