// Three targets, one per colour channel; additive blending sums the virtual point lights of a cell.
flat in vec4 fRed;
flat in vec4 fGreen;
flat in vec4 fBlue;
layout(location = 0) out vec4 red;
layout(location = 1) out vec4 green;
layout(location = 2) out vec4 blue;

void main() {
  red = fRed;
  green = fGreen;
  blue = fBlue;
}
