// Which pixel a low-resolution sample stands on: the middle of its block, the last pixel where the block is cut.
uniform int lowStep;  // pixels between samples

ivec2 lowPixel(ivec2 low) { return min(low * lowStep + lowStep / 2, textureSize(visibleDepth, 0) - 1); }
