// Homogeneous participating media: free flights and scattering, unbiased for any ratio of the channels' coefficients.
//
// A channel j is chosen with probability q_j proportional to the path's throughput, a distance t drawn from the
// exponential density of a rate r_j, and all channels are weighted by the balance heuristic [Miller2019; Chiang2016]:
//   collision at t:      throughput_c *= sigma_s,c T_c(t) / sum_j q_j r_j exp(-r_j t)
//   boundary at d <= t:  throughput_c *= T_c(d) / sum_j q_j exp(-r_j d)
// The rate is sigma_t or, where most is absorbed, sigma_s: light that passes is then weakened instead of lost by chance
// [SpanierGelbard1969]. As sigma_s <= r <= sigma_t, no weight exceeds the number of channels. exp(-r_min t) is taken
// out of numerators and denominators, which would underflow from an optical depth of 87 on.
#include "shared/media.h"
#include "pathtracer/numeric.glsl"
#include "pathtracer/phase.glsl"

const float kFar = 1e30;  // a distance that no scene has; its products with coefficients stay finite
const float kLeastDensity = 1e-37;  // no channel is live where a path's throughput has underflowed: its weight is 0

// Zero for zero throughput: there is no channel to choose then, and no path to continue.
vec3 channelProbabilities(vec3 throughput) {
  float sum = throughput.r + throughput.g + throughput.b;
  return sum > 0.0 ? throughput / sum : vec3(0.0);
}

// u in [0,1). Never picks a channel of probability 0 if another has a positive one.
int pickChannel(vec3 q, float u) {
  float r = u * (q.r + q.g + q.b);
  if (r < q.r) return 0;
  if (r < q.r + q.g) return 1;
  return q.b > 0.0 ? 2 : (q.g > 0.0 ? 1 : 0);
}

// The smallest coefficient of the live channels.
float leastOf(vec3 coefficients, bvec3 live) {
  vec3 bounded = mix(vec3(3e38), coefficients, live);
  return min(min(bounded.r, bounded.g), bounded.b);
}

// exp(-c t) of the live channels' coefficients c, over exp(-least t); 0 for dead channels.
vec3 relativeTransmittance(vec3 coefficients, bvec3 live, float least, float t) {
  return mix(vec3(0.0), exp(-(coefficients - least) * t), live);
}

// Distance to the next collision.
float flightDistance(MediumRecord medium, int channel, uint k) {
  float rate = medium.rate[channel];
  return rate > 0.0 ? min(exponentialSample(k) / rate, kFar) : kFar;
}

// T_c / sum_j q_j r_j exp(-r_j t): the weight of a quantity per unit length that is evaluated at a collision. 0 in
// channels without collisions.
vec3 collisionWeight(MediumRecord medium, vec3 q, float t) {
  bvec3 live = bvec3(vec3(greaterThan(q, vec3(0.0))) * vec3(greaterThan(medium.rate, vec3(0.0))));
  float least = leastOf(medium.rate, live);
  return relativeTransmittance(medium.extinction, live, least, t) /
         max(dot(q, medium.rate * relativeTransmittance(medium.rate, live, least, t)), kLeastDensity);
}

vec3 scatteringWeight(MediumRecord medium, vec3 q, float t) {
  if (medium.greyExtinction != 0) return medium.albedo;
  return medium.albedo * medium.extinction * collisionWeight(medium, q, t);
}

// The weight for reaching the boundary at distance d.
vec3 passageWeight(MediumRecord medium, vec3 q, float d) {
  if (medium.greyExtinction != 0) return vec3(1.0);
  bvec3 live = greaterThan(q, vec3(0.0));
  float least = leastOf(medium.rate, live);
  return relativeTransmittance(medium.extinction, live, least, d) /
         max(dot(q, relativeTransmittance(medium.rate, live, least, d)), kLeastDensity);
}

vec3 phaseValue(MediumRecord medium, vec3 w, vec3 to) {
  return medium.phase == 1 ? vec3(rayleighPdf(w, to)) : henyeyGreensteinPdf(w, to, medium.oneMinusG, medium.onePlusG);
}

// A direction from the phase function of a channel chosen by q; `weight` by the balance heuristic if the channels' g
// differ.
// pdf: the density of the direction, over all channels.
vec3 phaseSample(MediumRecord medium, vec3 w, vec3 q, float u, vec2 xi, out vec3 weight, out float pdf) {
  weight = vec3(1.0);
  if (medium.phase == 1) {
    vec3 to = rayleighSample(w, xi);
    pdf = rayleighPdf(w, to);
    return to;
  }
  int channel = medium.greyPhase != 0 ? 0 : pickChannel(q, u);
  vec3 to = henyeyGreensteinSample(w, medium.oneMinusG[channel], medium.onePlusG[channel], xi);
  vec3 p = henyeyGreensteinPdf(w, to, medium.oneMinusG, medium.onePlusG);
  pdf = medium.greyPhase != 0 ? p.r : dot(q, p);
  if (medium.greyPhase == 0) weight = p / pdf;
  return to;
}
