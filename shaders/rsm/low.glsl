// The pixel of a low-resolution sample: the middle of its block, or the last pixel if the block is cut off by the
// border.
uniform int lowStep;  // pixels between samples

ivec2 lowPixel(ivec2 low) { return min(low * lowStep + lowStep / 2, textureSize(visibleDepth, 0) - 1); }
