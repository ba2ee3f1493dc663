// For tests: evaluates the path tracer's functions for media and boundaries at given arguments.
uint loopIterations = 0u;  // loop iterations so far, as in bvh.glsl
#include "pathtracer/density.glsl"
#include "pathtracer/boundary.glsl"
#include "pathtracer/fresnel.glsl"
layout(local_size_x = 64) in;
struct Probe {
  vec4 a, b;
  uvec4 k;
};
struct Answer {
  vec4 a, b;
};
layout(std430, binding = 3) readonly buffer Probes { Probe probes[]; };
layout(std430, binding = 4) writeonly buffer Answers { Answer answers[]; };
layout(std430, binding = 2) readonly buffer Media { MediumRecord media[]; };
uniform int what;

float unit(uint k) { return float(k >> 8) * 5.9604644775390625e-8; }

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= uint(probes.length())) return;
  Probe p = probes[i];
  Answer r = Answer(vec4(0.0), vec4(0.0));
  if (what == 0) {
    r.a = vec4(exponentialSample(p.k.x), oneMinusExp(p.a.x), negativeLog1m(p.a.y), 0.0);
  } else if (what == 1) {
    vec3 to = henyeyGreensteinSample(p.a.xyz, p.b.x, p.b.y, vec2(unit(p.k.x), unit(p.k.y)));
    r.a = vec4(to, henyeyGreensteinPdf(p.a.xyz, to, p.b.xxx, p.b.yyy).r);
    r.b.x = 0.5 * dot(p.a.xyz - to, p.a.xyz - to);
  } else if (what == 2) {
    r.a.xyz = henyeyGreensteinPdf(p.a.xyz, p.b.xyz, vec3(p.a.w, 1.0, p.b.w), vec3(p.b.w, 1.0, p.a.w));
    r.a.w = rayleighPdf(p.a.xyz, p.b.xyz);
  } else if (what == 3) {
    r.a.xyz = rayleighSample(p.a.xyz, vec2(unit(p.k.x), unit(p.k.y)));
  } else if (what == 4) {
    float cosT;
    r.a.x = fresnelDielectric(p.a.x, p.a.y, cosT);
    r.a.y = cosT;
  } else if (what == 5) {
    vec3 q = channelProbabilities(p.a.xyz);
    MediumRecord medium = media[p.k.x];
    int channel = pickChannel(q, unit(p.k.y));
    r.a = vec4(scatteringWeight(medium, q, p.a.w), float(channel));
    r.b = vec4(passageWeight(medium, q, p.a.w), flightDistance(medium, channel, p.k.z));
  } else if (what == 6) {
    DensityRecord g = densityRecords[p.k.x];
    r.a.x = densityAt(g, (p.a.xyz - g.min) * g.cellsPerUnit);
  } else if (what == 7) {
    // Along a ray: the length in the box, the minimum of bound minus density, and the optical depth of the density by
    // the midpoint rule.
    DensityRecord g = densityRecords[p.k.x];
    DensityMarch march;
    float slack = 1e30, inBox = 0.0, parts = 0.0, depth = 0.0, bound;
    if (densityMarchStart(g, p.a.xyz, p.b.xyz, p.a.w, march))
      // ends: as many as blocks
      for (int left = densityMostBlocks(g); left > 0 && densityMarchNext(g, march, bound); --left) {
        float step = (march.far - march.near) / 64.0;
        for (int s = 0; s < 64; ++s) {
          float d = densityAt(g, march.origin + (march.near + (float(s) + 0.5) * step) * march.direction);
          slack = min(slack, bound - d);
          depth += d * step;
        }
        inBox += march.far - march.near;
        parts += 1.0;
      }
    r.a = vec4(inBox, slack, parts, depth);
  } else if (what == 9) {
    DensityRecord g = densityRecords[p.k.x];
    DensityMarch march;
    if (densityMarchStart(g, p.a.xyz, p.b.xyz, p.a.w, march)) {
      float integral = densityIntegral(g, march.origin, march.direction, march.near, march.last);
      r.a = vec4(integral, float(loopIterations), 0.0, 0.0);
    }
  } else if (what == 8) {
    // k.x: entries, lowest rank first, 8 bits each; k.y: their number; k.z: exits, likewise; k.w: their number.
    uvec4 inside = uvec4(0u);
    bool sound = true;
    for (uint n = 0u; n < 4u && n < p.k.y; ++n)
      sound = crossBoundary(inside, int((p.k.x >> (8u * n)) & 255u), true) && sound;
    for (uint n = 0u; n < 4u && n < p.k.w; ++n)
      sound = crossBoundary(inside, int((p.k.z >> (8u * n)) & 255u), false) && sound;
    r.a = vec4(topRank(inside), mediumInside(inside), iorInside(inside), sound);
  }
  answers[i] = r;
}
