// Per-frame data for every pass: uniform block 0.
#pragma once
#include "shared/types.h"

SHARED_BEGIN

struct FrameConstants {
  mat4 clipFromWorld;     // the camera's
  mat4 sunClipFromWorld;  // orthographic; used by the shadow map and the reflective shadow map
  vec3 cameraPosition;     // where rays of a perspective view meet; any point of an orthographic one's plane
  float exposure;          // multiplies radiance before tone mapping
  vec3 sunDirection;       // unit, along which light travels
  float shadowNormalOffset;  // world units: a receiver is moved this far along its normal before the shadow test
  vec3 sunIrradiance;      // across the rays
  int pixelSample;         // number of the sample of each pixel that is drawn, from 0
  vec3 background;         // radiance where there is no surface
  int pixelSamples;        // that a picture has
  vec3 orthographicAxis;   // unit, along an orthographic view; 0: the view is perspective
  float sunTangent;        // of half the angle of the sun's disc; 0 where its shadows have no penumbra
  float sampleArea;        // of a pixel, that one sample of this frame stands for; 0: a point
  float padding0, padding1, padding2;
};
SHARED_BLOCK(FrameConstants)

SHARED_END
