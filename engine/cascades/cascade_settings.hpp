// The settings of nested grids around the camera, for the techniques that store light in them (no GL calls).
#pragma once

#include "cascades/cascades.hpp"
#include "frame/setting.hpp"

/// Entries for a technique's table of settings. prefix: of their keys; Settings: its settings, with a member
/// `cascades`. ofCells, ofCascades: literals, what more of them do in this technique; or "".
#define CASCADE_SETTINGS(prefix, Settings, source, ofCells, ofCascades)                                           \
  {prefix ".cells", number(SETTING_FIELD(Settings, cascades.cells), 1, 128), "cells",                             \
   "along each side of every cascade" ofCells, source},                                                           \
      {prefix ".cascades", number(SETTING_FIELD(Settings, cascades.cascades), 1, MAX_CASCADES), "",               \
       "nested grids" ofCascades, source},                                                                        \
      {prefix ".cell-size", number(SETTING_FIELD(Settings, cascades.cellSize), 0.0, 1e12, "auto"), "scene units", \
       "cell size of the coarsest cascade; auto: half of its cells span the scene", ""},                          \
      {prefix ".ratio", number(SETTING_FIELD(Settings, cascades.ratio), 1.0, 16.0), "",                           \
       "ratio of a cascade's cell size to the next finer one's", source},                                         \
  {                                                                                                               \
    prefix ".push", number(SETTING_FIELD(Settings, cascades.push), 0.0, 1.0), "half extents",                     \
        "offset of the grids ahead of the camera", "[LPV2015, 6.4]"                                               \
  }
