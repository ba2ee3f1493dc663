// Random numbers addressed by (pixel, sample, event on the path, purpose). They are stateless, so any path can be
// replayed by itself, and the order in which paths are traced does not matter.
//
// Most numbers are hashes, pcg4d [JarzynskiOlano2020]. Pairs of numbers for the first events come from Sobol's
// (0,2)-sequence, with shuffled order and Owen-scrambled points per pixel and purpose, by hashes [Burley2020].

const uint kLowDiscrepancyEvents = 4u;

// Purposes: one per decision. Media use those from kFreePurpose on.
const uint kPurposeFilm = 0u;
const uint kPurposeLight = 1u;      // where on the light
const uint kPurposePick = 2u;       // which light
const uint kPurposeScatter = 3u;    // the new direction
const uint kPurposeChoice = 4u;     // lobe, roulette
const uint kFreePurpose = 5u;

uvec4 pcg4d(uvec4 v) {
  v = v * 1664525u + 1013904223u;
  v.x += v.y * v.w;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v.w += v.y * v.z;
  v ^= v >> 16u;
  v.x += v.y * v.w;
  v.y += v.z * v.x;
  v.z += v.x * v.y;
  v.w += v.y * v.z;
  return v;
}

// [0, 1) in steps of 2^-24.
float unitFloat(uint word) { return float(word >> 8u) * (1.0 / 16777216.0); }
vec2 unitFloat(uvec2 words) { return vec2(words >> 8u) * (1.0 / 16777216.0); }

// An integer in [0, count), from all 32 bits.
uint scaledWord(uint word, uint count) {
  uint high, low;
  umulExtended(word, count, high, low);
  return high;
}

// The k-th of `count` words that lie in equal parts of all 32-bit numbers; count: a power of two.
uint stratifiedWord(uint word, uint k, uint count) { return word / count + k * (0xffffffffu / count + 1u); }

struct PathNumbers {
  uint pixel;   // its index in the picture
  uint sampleIndex;
  uint seed;    // of the picture
};

#if LINEAR_SEEDS
uint pcgOutput(uint state) {
  uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
  return (word >> 22u) ^ word;
}

// [VPT2024, 5.4]: PCG rxs_m_xs_32, seeded with the number of the pixel. A pixel's draws are successive states on the
// one cycle of 2^32 that all pixels share, 16 words per event here.
uvec4 linearWords(PathNumbers numbers, uint event, uint purpose) {
  uint steps = ((numbers.sampleIndex * 64u + event) * 16u + purpose) * 4u + 1u;
  uint factor = 747796405u, addend = 1u, state = numbers.pixel + numbers.seed;
  for (; steps > 0u; steps >>= 1u) {  // ends: after 32 bits
    if ((steps & 1u) != 0u) state = state * factor + addend;
    addend *= factor + 1u;
    factor *= factor;
  }
  uvec4 words;
  for (int i = 0; i < 4; ++i) {
    words[i] = pcgOutput(state);
    state = state * 747796405u + 1u;
  }
  return words;
}
#endif

uvec4 randomWords(PathNumbers numbers, uint event, uint purpose) {
#if LINEAR_SEEDS
  return linearWords(numbers, event, purpose);
#endif
  return pcg4d(uvec4(numbers.pixel, numbers.sampleIndex, event, purpose ^ numbers.seed));
}

// Owen scrambling of a bit-reversed number: a hash of the lower bits decides whether to flip each bit [Burley2020].
uint owenReversed(uint x, uint seed) {
  x ^= x * 0x3d20adeau;
  x += seed;
  x *= (seed >> 16u) | 1u;
  x ^= x * 0x05526c56u;
  x ^= x * 0x53a22864u;
  return x;
}

// The second dimension of Sobol's sequence before bit reversal. Bit k is the sum over j of bit j times binomial(j, k),
// which is odd if k's bits are a subset of j's: a sum over supersets, one step per bit of the index.
uint sobolReversed(uint i) {
  i ^= (i >> 1u) & 0x55555555u;
  i ^= (i >> 2u) & 0x33333333u;
  i ^= (i >> 4u) & 0x0f0f0f0fu;
  i ^= (i >> 8u) & 0x00ff00ffu;
  i ^= (i >> 16u) & 0x0000ffffu;
  return i;
}

// Index of a point of Sobol's sequence: sampleIndex shuffled, of which 2^k in turn have an aligned part of 2^k points.
uint shuffledIndex(PathNumbers numbers, uvec4 seeds) {
  return bitfieldReverse(owenReversed(bitfieldReverse(numbers.sampleIndex), seeds.x));
}

uvec4 seedsOf(PathNumbers numbers, uint event, uint purpose) {
  return pcg4d(uvec4(numbers.pixel, 0xffffffffu, event, purpose ^ numbers.seed));
}

// Two numbers of 32 random bits each.
uvec2 randomWordPair(PathNumbers numbers, uint event, uint purpose) {
#if LINEAR_SEEDS
  return linearWords(numbers, event, purpose).xy;
#endif
  if (event >= kLowDiscrepancyEvents) return randomWords(numbers, event, purpose).xy;
  uvec4 seeds = seedsOf(numbers, event, purpose);
  uint i = shuffledIndex(numbers, seeds);
  return bitfieldReverse(uvec2(owenReversed(i, seeds.y), owenReversed(sobolReversed(i), seeds.z)));
}

// Three more dimensions of the points that randomWordPair has for an event and a purpose [JoeKuo2008]: numbers that
// decide together with that pair how much light a path finds, so that all five are spread evenly.
uvec3 furtherWords(PathNumbers numbers, uint event, uint purpose) {
  uvec4 seeds = seedsOf(numbers, event, purpose);
  uvec3 words = uvec3(0u), third = uvec3(0x80000000u), second = uvec3(0xc0000000u, 0xc0000000u, 0x40000000u),
        first = uvec3(0x60000000u, 0x20000000u, 0x20000000u);
  uint index = shuffledIndex(numbers, seeds);
  for (uint k = 0u; k < 16u; ++k) {  // of further bits, one part of the sequence repeats
    words ^= third * (index >> k & 1u);
    // direction numbers of the primitive polynomials x^2 + x + 1, x^3 + x + 1 and x^3 + x^2 + 1
    uvec3 next = uvec3(first.x ^ second.x ^ second.x >> 2u, second.y ^ third.y ^ third.y >> 3u,
                       first.z ^ third.z ^ third.z >> 3u);
    third = second, second = first, first = next;
  }
  uvec4 further = pcg4d(seeds);
  for (int k = 0; k < 3; ++k) words[k] = bitfieldReverse(owenReversed(bitfieldReverse(words[k]), further[k]));
  return words;
}

// Two numbers in [0, 1).
vec2 randomPair(PathNumbers numbers, uint event, uint purpose) {
  return unitFloat(randomWordPair(numbers, event, purpose));
}
