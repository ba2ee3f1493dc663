#include "shared/bindings.h"
#include "shared/frame.h"
layout(std140, binding = BLOCK_FRAME) uniform FrameBlock { FrameConstants frame; };
