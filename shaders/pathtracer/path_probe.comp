// For tests: the path tracer's pure functions in isolation, one invocation per input. PROBE selects the function.
layout(local_size_x = 64) in;
#include "rays/random.glsl"
#include "rays/bsdf.glsl"
#include "pathtracer/fresnel.glsl"
#if PROBE == 3
#include "lib/spherical_triangle.glsl"
uniform vec3 corner;
#endif
layout(std430, binding = 0) readonly restrict buffer Inputs { vec4 inputs[]; };
layout(std430, binding = 1) writeonly restrict buffer Outputs { vec4 outputs[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (2u * i >= uint(inputs.length())) return;
  vec4 a = inputs[2u * i], b = inputs[2u * i + 1u], first = vec4(0.0), second = vec4(0.0);
  float pdf = 0.0;
#if PROBE == 0
  // a: pixel, sample, event, purpose.
  // bounded: tests ask for numbers that floats hold
  uvec4 k = uvec4(a);
  PathNumbers numbers = PathNumbers(k.x, k.y, uint(b.x));  // bounded: likewise
  uvec4 words = randomWords(numbers, k.z, k.w);
  first = vec4(randomPair(numbers, k.z, k.w), vec2(words.xy >> 8u));
  second = vec4(unitFloat(words.zw), float(scaledWord(words.x, 1000u)), 0.0);
#elif PROBE == 1
  // a: o, alpha; b: i, eta.
  first.x = ggxReflect(a.xyz, b.xyz, a.w, pdf);
  first.y = pdf;
  float cosT;
  first.z = fresnelDielectric(a.z, b.w, cosT);
  first.w = cosT;
  vec3 h;
  second.x = ggxRefract(a.xyz, vec3(b.xy, -b.z), a.w, b.w, h, pdf);
  second.y = pdf;
  second.zw = schlick(vec3(0.04, 0.9, 0.0), a.z).xy;
#elif PROBE == 2
  // a: o, alpha; b: two numbers. A direction reflected by a bsdf and its density; a direction about the normal.
  vec3 h = ggxSample(a.xyz, a.w, b.xy), r = reflect(-a.xyz, h);
  ggxReflect(a.xyz, r, a.w, pdf);
  first = vec4(r, pdf);
  second = vec4(cosineSample(normalize(a.xyz), b.xy), powerHeuristic(b.x, b.y));
#elif PROBE == 3
  // a, b: corners and two numbers. A direction to the triangle and its solid angle.
  float angle = sphericalTriangle(a.xyz, b.xyz, corner);
  first = vec4(sphericalTriangleSample(a.xyz, b.xyz, corner, angle, vec2(a.w, b.w)), angle);
#elif PROBE == 4
  // a: as of 0.
  uvec4 k = uvec4(a);  // bounded: likewise
  PathNumbers numbers = PathNumbers(k.x, k.y, uint(b.x));  // bounded: likewise
  first = vec4(vec3(furtherWords(numbers, k.z, k.w) >> 8u), 0.0);
#endif
  outputs[2u * i] = first;
  outputs[2u * i + 1u] = second;
}
