// Colour times texture; alpha is passed through.
in vec2 uv;
in vec4 color;
layout(binding = 0) uniform sampler2D picture;
layout(location = 0) out vec4 displayColor;

void main() { displayColor = color * texture(picture, uv); }
