// Displays a triangle file [RAD2008 section 3.8]. The CPU chooses the colours, per triangle or per corner.
layout(location = 0) in vec3 corner;
layout(location = 1) in vec3 colour;
uniform mat4 clipFromWorld;
out vec3 shown;
#if TEXTURED
layout(location = 2) in vec2 textureCoordinate;
out vec2 picturePlace;
#endif

void main() {
  shown = colour;
#if TEXTURED
  picturePlace = textureCoordinate;
#endif
  gl_PointSize = 2.0;
  gl_Position = clipFromWorld * vec4(corner, 1.0);
}
