// Lines between points of a scene, drawn over a picture of it. Each line is two triangles, a few pixels wide, placed
// where the picture lies in the target.
layout(location = 0) in vec3 start;
layout(location = 1) in vec3 end;
layout(location = 2) in vec2 corner;  // which end, 0 or 1; which side, -1 or 1
layout(location = 3) in vec4 color;
uniform mat4 clipFromWorld;
uniform vec2 pixels;   // of the target
uniform vec2 middle;   // pixel of the target where `centre` of the picture lies
uniform vec2 centre;   // point of the picture, 0..1
uniform vec2 scale;    // size of the whole picture in pixels of the target
uniform float width;   // pixels
uniform float nearest; // lines are clipped at this distance along the view
out float vInverseDepth;  // linear on the screen
out float vAcross;
flat out vec4 vColor;

vec2 onTarget(vec4 clip) { return middle + (0.5 * clip.xy / clip.w + 0.5 - centre) * scale; }

void main() {
  vec4 a = clipFromWorld * vec4(start, 1.0), b = clipFromWorld * vec4(end, 1.0);
  vColor = color;
  vAcross = corner.y;
  vInverseDepth = 1.0;
  gl_Position = vec4(2.0, 2.0, 2.0, 1.0);  // outside the clip volume: the whole line lies behind the camera
  if (max(a.w, b.w) < nearest) return;
  if (a.w < nearest) a = mix(a, b, (nearest - a.w) / (b.w - a.w));
  if (b.w < nearest) b = mix(b, a, (nearest - b.w) / (a.w - b.w));
  vec2 from = onTarget(a), to = onTarget(b), along = to - from;
  float far = length(along);
  along = far > 1e-6 ? along / far : vec2(1.0, 0.0);
  vec2 place = (corner.x < 0.5 ? from : to) + 0.5 * (width + 1.0) * corner.y * vec2(-along.y, along.x);
  vInverseDepth = 1.0 / (corner.x < 0.5 ? a.w : b.w);
  gl_Position = vec4(2.0 * place / pixels - 1.0, 0.0, 1.0);
}
