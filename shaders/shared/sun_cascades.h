// The sun's cascades: uniform block 4, present only if shadow.cascades is above 1. Cascade 0 is the finest.
#pragma once
#include "shared/types.h"

SHARED_BEGIN

#define SUN_MAX_CASCADES 4

struct SunCascadeConstants {
  mat4 clipFromWorld[SUN_MAX_CASCADES];  // orthographic
  vec4 normalOffset;                     // world units, per cascade: a receiver is moved this far along its normal
};
SHARED_BLOCK(SunCascadeConstants)

SHARED_END
