// Deviations: what the published originals do differently, each a named switch (no GL, pure).
#pragma once

#include "frame/render_settings.hpp"

namespace lucerna {

/// Where a deviation is found: in the published text, in the program published with it, in both, or in other
/// publications.
enum class DeviationSource : unsigned { elsewhere = 0, text = 1, program = 2, both = text | program };

struct Deviation {
  const char* name;  ///< technique, dot, name of the deviation
  const char* meaning;  ///< one line
  DeviationSource source;
  bool (*isOn)(const RenderSettings&);
  void (*turn)(RenderSettings&, bool on);

  bool inOriginal() const { return (static_cast<unsigned>(source) & 1u) != 0; }
  bool inDemo() const { return (static_cast<unsigned>(source) & 2u) != 0; }
};

/// A deviation that is a bool in the settings of a technique.
#define LUCERNA_DEVIATION(name, meaning, source, Settings, member)                        \
  ::lucerna::Deviation {                                                                  \
    name, meaning, ::lucerna::DeviationSource::source,                                    \
        [](const ::lucerna::RenderSettings& s) { return bool{s.of<Settings>().member}; }, \
        [](::lucerna::RenderSettings& s, bool on) { s.of<Settings>().member = on; }       \
  }

}  // namespace lucerna
