// Counts surfaces per pixel, whether hidden or not.
layout(location = 0) out vec4 count;

void main() { count = vec4(1.0, 0.0, 0.0, 1.0); }
