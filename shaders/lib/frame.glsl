#include "shared/bindings.h"
#include "shared/frame.h"
layout(std140, binding = BLOCK_FRAME) uniform FrameBlock { FrameConstants frame; };

bool isOrthographic() { return dot(frame.orthographicAxis, frame.orthographicAxis) > 0.0; }

// Where the view's ray to a point starts. A perspective view has an axis of 0.
vec3 eyeOf(vec3 position) {
  if (!isOrthographic()) return frame.cameraPosition;
  return position - dot(position - frame.cameraPosition, frame.orthographicAxis) * frame.orthographicAxis;
}
