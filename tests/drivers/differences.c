// Where two OpenGL drivers may draw triangles differently, without Lucerna: depth of a sloped plane, polygon offset,
// coverage at an edge, filtered shadow comparisons, filtered colours, level of detail. docs/drivers.md has results.
//
//   gcc -O1 -o differences tests/drivers/differences.c -Wl,--no-as-needed -lOSMesa -lGL -lm
//   ./differences                            the installed driver
//   TOOLS/on softpipe ./differences          another one
#define GL_GLEXT_PROTOTYPES
#include <GL/osmesa.h>
#include <GL/gl.h>
#include <GL/glext.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { N = 64 };  // pixels each way
static float depth[N * N], colour[4 * N * N];

static GLuint shader(GLenum kind, const char* source) {
  const GLuint id = glCreateShader(kind);
  GLint ok = 0;
  glShaderSource(id, 1, &source, NULL);
  glCompileShader(id);
  glGetShaderiv(id, GL_COMPILE_STATUS, &ok);
  if (!ok) exit(1);
  return id;
}

static GLuint program(const char* fragment) {
  const GLuint id = glCreateProgram();
  const char* vertex = "#version 330\nlayout(location = 0) in vec4 p; void main() { gl_Position = p; }";
  glAttachShader(id, shader(GL_VERTEX_SHADER, vertex));
  glAttachShader(id, shader(GL_FRAGMENT_SHADER, fragment));
  glLinkProgram(id);
  glUseProgram(id);
  return id;
}

// From the left edge to column `right`, in pixels; depth 0.5 in the middle, sloped by sx and sy per pixel.
static void drawPlane(double right, double sx, double sy) {
  const double corner[6][2] = {{0, 0}, {right, 0}, {right, N}, {0, 0}, {right, N}, {0, N}};
  float p[24];
  for (int i = 0; i < 6; ++i) {
    const double x = corner[i][0] - N / 2, y = corner[i][1] - N / 2;
    p[4 * i] = (float)(x / (N / 2)), p[4 * i + 1] = (float)(y / (N / 2)), p[4 * i + 2] = (float)(2 * (sx * x + sy * y));
    p[4 * i + 3] = 1.0f;
  }
  glBufferData(GL_ARRAY_BUFFER, sizeof p, p, GL_STATIC_DRAW);
  glDrawArrays(GL_TRIANGLES, 0, 6);
}

static GLuint texture(GLint filter) {
  GLuint id = 0;
  glGenTextures(1, &id);
  glBindTexture(GL_TEXTURE_2D, id);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter == GL_NEAREST ? GL_NEAREST : GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  return id;
}

static void drawDepth(double right, double sx, double sy) {
  glClear(GL_DEPTH_BUFFER_BIT);
  drawPlane(right, sx, sy);
  glReadPixels(0, 0, N, N, GL_DEPTH_COMPONENT, GL_FLOAT, depth);
}

static void depthOfPlanes(void) {
  const double sx = 0.004, sy = 0.002;
  const float offsets[4][2] = {{0, 0}, {1, 0}, {2, 0}, {0, 1000}};
  program("#version 330\nvoid main() {}");
  for (int o = 0; o < 4; ++o) {
    (o > 0 ? glEnable : glDisable)(GL_POLYGON_OFFSET_FILL);
    glPolygonOffset(offsets[o][0], offsets[o][1]);
    drawDepth(N, sx, sy);
    double worst = 0.0;
    for (int i = 0; i < N * N; ++i) {
      const double plane = 0.5 + sx * (i % N + 0.5 - N / 2) + sy * (i / N + 0.5 - N / 2);
      worst = fmax(worst, fabs(depth[i] - plane - offsets[o][0] * sx - offsets[o][1] * exp2(-24)));
    }
    printf("depth with polygon offset %g, %g: off by %.2g at most\n", offsets[o][0], offsets[o][1], worst);
  }
  glDisable(GL_POLYGON_OFFSET_FILL);
  printf("an edge this far right of a pixel's centre covers it, in 1/1024 pixels:");
  for (int shift = -8; shift <= 8; ++shift) {
    drawDepth(N / 2 + 0.5 + shift / 1024.0, 0, 0);
    if (depth[N * N / 2 + N / 2] < 0.9f) printf(" %d", shift);
  }
  printf("\n");
}

static void drawColour(void) {
  drawPlane(N, 0, 0);
  glReadPixels(0, 0, N, N, GL_RGBA, GL_FLOAT, colour);
}

static void filters(void) {
  const float stored[4] = {0.2f, 0.8f, 0.2f, 0.8f};
  texture(GL_LINEAR);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, 2, 2, 0, GL_DEPTH_COMPONENT, GL_FLOAT, stored);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
  program("#version 330\nuniform sampler2DShadow s; out vec4 o;"
          "void main() { o = vec4(texture(s, vec3(gl_FragCoord.xy / 64.0, 0.5))); }");
  drawColour();
  printf("comparison with a linear filter, across two texels:");
  for (int x = 10; x < N; x += 6) printf(" %.3f", (double)colour[4 * (N * N / 2 + x)]);
  const unsigned char bytes[16] = {0, 0, 0, 255, 255, 255, 255, 255, 0, 0, 0, 255, 255, 255, 255, 255};
  texture(GL_LINEAR);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, 2, 2, 0, GL_RGBA, GL_UNSIGNED_BYTE, bytes);
  program("#version 330\nuniform sampler2D s; out vec4 o;"
          "void main() { o = texture(s, vec2(gl_FragCoord.x / 6400.0 + 0.5, 0.5)); }");
  drawColour();
  double worst = 0.0;
  for (int x = 0; x < N; ++x) worst = fmax(worst, fabs(colour[4 * (N * N / 2 + x)] - ((x + 0.5) / 3200.0 + 0.5)));
  printf("\n8-bit colours with a linear filter: off by %.4f at most\n", worst);
  texture(GL_LINEAR_MIPMAP_LINEAR);  // level k has the value 32 k
  for (int level = 0; level < 7; ++level) {
    static unsigned char texels[4 * N * N];
    memset(texels, 32 * level, sizeof texels);
    glTexImage2D(GL_TEXTURE_2D, level, GL_RGBA8, N >> level, N >> level, 0, GL_RGBA, GL_UNSIGNED_BYTE, texels);
  }
  const GLuint scaled = program("#version 330\nuniform sampler2D s; uniform float k; out vec4 o;"
                                "void main() { o = texture(s, gl_FragCoord.xy / 64.0 * k); }");
  worst = 0.0;
  for (double level = 0.0; level <= 3.0; level += 0.125) {
    glUniform1f(glGetUniformLocation(scaled, "k"), (float)exp2(level));
    drawColour();
    worst = fmax(worst, fabs(colour[4 * (N * N / 2 + N / 2)] * 255.0 / 32.0 - level));
  }
  printf("level of detail: off by %.3f at most\n", worst);
}

int main(void) {
  static char pixels[4 * N * N];
  const int wanted[] = {OSMESA_FORMAT, OSMESA_RGBA, OSMESA_DEPTH_BITS, 24, OSMESA_PROFILE, OSMESA_CORE_PROFILE,
                        OSMESA_CONTEXT_MAJOR_VERSION, 3, OSMESA_CONTEXT_MINOR_VERSION, 3, 0};
  const OSMesaContext context = OSMesaCreateContextAttribs(wanted, NULL);
  if (!context || !OSMesaMakeCurrent(context, pixels, GL_UNSIGNED_BYTE, N, N)) return 1;
  printf("%s\n", (const char*)glGetString(GL_RENDERER));
  GLuint array = 0, buffer = 0, target[2] = {0, 0};
  glGenVertexArrays(1, &array);
  glBindVertexArray(array);
  glGenBuffers(1, &buffer);
  glBindBuffer(GL_ARRAY_BUFFER, buffer);
  glEnableVertexAttribArray(0);
  glVertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, 0, NULL);
  glGenFramebuffers(2, target);
  glViewport(0, 0, N, N);

  glBindFramebuffer(GL_FRAMEBUFFER, target[0]);
  const GLuint depths = texture(GL_NEAREST);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT32F, N, N, 0, GL_DEPTH_COMPONENT, GL_FLOAT, NULL);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depths, 0);
  glDrawBuffer(GL_NONE);
  glReadBuffer(GL_NONE);
  glEnable(GL_DEPTH_TEST);
  depthOfPlanes();
  glDisable(GL_DEPTH_TEST);

  glBindFramebuffer(GL_FRAMEBUFFER, target[1]);
  const GLuint colours = texture(GL_NEAREST);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, N, N, 0, GL_RGBA, GL_FLOAT, NULL);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, colours, 0);
  filters();
  return glGetError() != GL_NO_ERROR;
}
