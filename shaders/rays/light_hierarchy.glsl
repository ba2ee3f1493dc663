// Draws a lamp from the root of a hierarchy on, at each node by what either half may bring to a point
// [ContyKulla2018]: engine/rays/light_hierarchy.hpp, which says what a texel holds. Needs tracer (PathConstants).
//
// A direction that a surface scatters may hit a lamp as well. What weighs the two ways against each other leaves the
// receiver's normal out, as the ray no longer knows it: `balance` is the probability without it over that with it.
#include "lib/packed_normal.glsl"
#include "rays/light_leaves.glsl"

const uint kLeafLink = 0x80000000u, kTwoSidedLink = 0x40000000u, kLinkMask = 0x3fffffffu;
const int kMostHierarchyDepth = 48;
const float kLeastBound = 0.01;  // of a cosine's bound, so that nothing is excluded by it, whatever rounding does
const float kLeastShare = 1e-7;  // of a choice

// Cosine of max(a - b, 0), of angles by their cosine and sine.
float cosineLess(vec2 a, vec2 b) { return a.x >= b.x ? 1.0 : dot(a, b); }
vec2 angleLess(vec2 a, vec2 b) { return a.x >= b.x ? vec2(1.0, 0.0) : vec2(dot(a, b), a.y * b.x - a.x * b.y); }
vec2 angleOfCosine(float cosine) { return vec2(cosine, sqrt(max(1.0 - cosine * cosine, 0.0))); }

// What the lamps of a node may bring to a position, relative to those of its sibling; y: to a surface with that
// normal. normal: zero where light arrives from all sides.
vec2 lampImportance(int at, vec3 position, vec3 normal, out uint link) {
  vec4 ball = uintBitsToFloat(texelFetch(lightHierarchy, at));
  uvec4 words = texelFetch(lightHierarchy, at + 1);
  link = words.w;
  vec3 to = ball.xyz - position;
  float distance2 = dot(to, to), radius2 = ball.w * ball.w;
  to *= inversesqrt(max(distance2, 1e-30));
  // of the ball: half of the angle that it is seen under
  vec2 within = distance2 > radius2 ? vec2(sqrt(1.0 - radius2 / distance2), ball.w * inversesqrt(distance2))
                                    : vec2(-1.0, 0.0);
  float along = -dot(unpackNormal(words.y), to);
  if ((link & kTwoSidedLink) != 0u) along = abs(along);
  vec2 cosines = unpackHalf2x16(words.z);
  float emission = cosineLess(angleLess(angleOfCosine(along), angleOfCosine(cosines.x)), within);
  if (emission < cosines.y) emission = 0.0;
  float alone =
      uintBitsToFloat(words.x) / max(distance2, max(radius2, 1e-30)) * mix(kLeastBound, 1.0, max(emission, 0.0));
  float reception = normal == vec3(0.0) ? 1.0 : cosineLess(angleOfCosine(dot(normal, to)), within);
  return clamp(vec2(alone, alone * mix(kLeastBound, 1.0, max(reception, 0.0))), 1e-30, 1e30);
}

float shareOf(float own, float other) { return max(own / (own + other), kLeastShare); }

int texelOfPair(uint pair) { return int((tracer.lampPairs + 2u) / 2u + 4u * pair); }  // behind the leaves

// words: random.
LightPick drawLamp(uvec4 words, vec3 position, vec3 normal) {
  LightPick result = LightPick(lampOfLeaf(0u).x, tracer.lampPick, 1.0);  // of a single lamp
  if (tracer.lampPairs == 0u) return result;
  uint pair = 0u;
  for (int level = 0; level < kMostHierarchyDepth; ++level) {
    uint firstLink, secondLink;
    vec2 first = lampImportance(texelOfPair(pair), position, normal, firstLink),
         second = lampImportance(texelOfPair(pair) + 2, position, normal, secondLink);
    // The rarer one takes the least random numbers, which floats tell apart best.
    float rarer = shareOf(min(first.y, second.y), max(first.y, second.y));
    bool isRare = float(words.x) < rarer * 4294967296.0, isSecond = isRare == (second.y < first.y);
    float share = isRare ? rarer : 1.0 - rarer;
    result.probability *= share;
    result.balance *= (isSecond ? shareOf(second.x, first.x) : shareOf(first.x, second.x)) / share;
    uint split = firstLink & kLinkMask;
    if (((isSecond ? secondLink : firstLink) & kLeafLink) != 0u) {
      result.light = lampOfLeaf(isSecond ? split : split - 1u).x;
      break;
    }
    pair = isSecond ? secondLink & kLinkMask : pair + 1u;
    words = pcg4d(words);
  }
  return result;
}

// The probability of a lamp, by the number of its leaf, without the receiver's normal.
float lampProbability(uint leaf, vec3 position) {
  float result = tracer.lampPick;
  if (tracer.lampPairs == 0u) return result;
  uint pair = 0u;
  for (int level = 0; level < kMostHierarchyDepth; ++level) {
    uint firstLink, secondLink;
    float first = lampImportance(texelOfPair(pair), position, vec3(0.0), firstLink).x,
          second = lampImportance(texelOfPair(pair) + 2, position, vec3(0.0), secondLink).x;
    bool isSecond = leaf >= (firstLink & kLinkMask);
    result *= isSecond ? shareOf(second, first) : shareOf(first, second);
    if (((isSecond ? secondLink : firstLink) & kLeafLink) != 0u) break;
    pair = isSecond ? secondLink & kLinkMask : pair + 1u;
  }
  return result;
}
