// lucerna check, part sharing: several processes draw at once. On the NVIDIA GPU that was tried the driver reset the
// GPU every few seconds under such load (docs/drivers.md). Comes last: a reset may hit other programs.
#include "check/check.hpp"

#include "check/child.hpp"

#include <fmt/core.h>

#include <array>
#include <filesystem>
#include <thread>

namespace lucerna::demo::check {

namespace {

Finding drawAtOnce(const UnitInput& input) {
  constexpr std::size_t kProcesses = 4;
  std::array<ChildEnd, kProcesses> ends;
  std::array<std::thread, kProcesses> threads;
  at(fmt::format("drawing in {} processes", kProcesses));
  for (std::size_t i = 0; i < kProcesses; ++i)
    threads[i] = std::thread([&, i] {
      std::vector<std::string> words{"check",
                                     "--part",
                                     i % 2 ? "pictures/cache-cornell" : "pictures/gather-cornell",
                                     "--out",
                                     (std::filesystem::path(input.out) / fmt::format("sharing{}", i)).string(),
                                     "--reference",
                                     input.reference};
      if (!input.common.host.empty()) words.insert(words.end(), {"--host", input.common.host});
      ends[i] = runChild(words, {}, std::filesystem::path(input.out) / "logs" / fmt::format("sharing{}.txt", i),
                         input.seconds);
    });
  for (std::thread& thread : threads) thread.join();
  Finding finding;
  double longest = 0.0;
  for (const ChildEnd& end : ends) {
    longest = std::max(longest, end.seconds);
    finding.right = finding.right && !end.timedOut && end.code == 0 && end.signal == 0;
    if (end.timedOut) finding.text += fmt::format("not ended in {:.0f} s, in {}; ", input.seconds, end.place);
    else if (end.signal != 0) finding.text += fmt::format("signal {}; ", end.signal);
    else if (end.code != 0) finding.text += (end.message.empty() ? "wrong picture" : end.message) + "; ";
  }
  finding.text += fmt::format("{} processes, {:.1f} s", kProcesses, longest);
  return finding;
}

}  // namespace

std::vector<Unit> sharingUnits() { return {{"sharing", "four-processes", 60.0, drawAtOnce, "pictures/cache-cornell"}}; }

}  // namespace lucerna::demo::check
