// Numbers as unevaluated sums of two floats, 48 bits in all, for where a float's 24 are not enough and doubles are slow
// or emulated on a GPU. Handles three numbers at once. Error-free sums after [Knuth1997, 4.2.2], products after
// [Dekker1971]. `precise` keeps compilers from contracting and reordering. fma() is avoided: a driver may compute it as
// two operations. Range: no product may overflow, and errors below 1e-38 are lost.

struct Pairs {
  vec3 hi, lo;  // |lo| is at most about 2^-22 |hi|
};

// hi + lo renormalised; requires |hi| >= |lo|.
Pairs pairsNormal(vec3 hi, vec3 lo) {
  precise vec3 sum = hi + lo;
  precise vec3 rest = lo - (sum - hi);
  return Pairs(sum, rest);
}

// Exact.
Pairs pairsDifference(vec3 a, vec3 b) {
  precise vec3 difference = a - b;
  precise vec3 back = difference - a;
  precise vec3 rest = (a - (difference - back)) - (b + back);
  return Pairs(difference, rest);
}

// The upper 12 of the 24 significant bits: products of such halves are exact.
vec3 upperHalf(vec3 a) { return uintBitsToFloat(floatBitsToUint(a) & 0xfffff000u); }

// a b - product; exact if `product` is a b rounded.
vec3 productRest(vec3 a, vec3 b, vec3 product) {
  vec3 au = upperHalf(a), bu = upperHalf(b);
  precise vec3 al = a - au;
  precise vec3 bl = b - bu;
  precise vec3 rest = (((au * bu - product) + au * bl) + al * bu) + al * bl;
  return rest;
}

// Relative error about 2^-46.
Pairs pairsProduct(Pairs a, Pairs b) {
  precise vec3 product = a.hi * b.hi;
  precise vec3 rest = productRest(a.hi, b.hi, product) + (a.hi * b.lo + a.lo * b.hi);
  return Pairs(product, rest);
}

// Error about 2^-46 of the largest term.
Pairs pairsDifference(Pairs a, Pairs b) {
  Pairs high = pairsDifference(a.hi, b.hi);
  precise vec3 low = high.lo + (a.lo - b.lo);
  return pairsNormal(high.hi, low);
}

Pairs pairsCross(Pairs a, Pairs b) {
  return pairsDifference(pairsProduct(Pairs(a.hi.yzx, a.lo.yzx), Pairs(b.hi.zxy, b.lo.zxy)),
                         pairsProduct(Pairs(a.hi.zxy, a.lo.zxy), Pairs(b.hi.yzx, b.lo.yzx)));
}

// The same for two numbers at once.
struct PairOfPairs {
  vec2 hi, lo;
};

PairOfPairs pairsProduct(PairOfPairs a, PairOfPairs b) {
  precise vec2 product = a.hi * b.hi;
  vec2 au = uintBitsToFloat(floatBitsToUint(a.hi) & 0xfffff000u),
       bu = uintBitsToFloat(floatBitsToUint(b.hi) & 0xfffff000u);
  precise vec2 al = a.hi - au;
  precise vec2 bl = b.hi - bu;
  precise vec2 cut = (((au * bu - product) + au * bl) + al * bu) + al * bl;
  precise vec2 rest = cut + (a.hi * b.lo + a.lo * b.hi);
  return PairOfPairs(product, rest);
}

PairOfPairs pairsDifference(PairOfPairs a, PairOfPairs b) {
  precise vec2 difference = a.hi - b.hi;
  precise vec2 back = difference - a.hi;
  precise vec2 rest = (a.hi - (difference - back)) - (b.hi + back);
  precise vec2 low = rest + (a.lo - b.lo);
  precise vec2 sum = difference + low;
  precise vec2 left = low - (sum - difference);
  return PairOfPairs(sum, left);
}

// A single number: x + y.
vec2 pairsDot(Pairs a, Pairs b) {
  Pairs p = pairsProduct(a, b);
  precise float xy = p.hi.x + p.hi.y;
  precise float backXy = xy - p.hi.x;
  precise float sum = xy + p.hi.z;
  precise float back = sum - xy;
  precise float rest = ((p.hi.x - (xy - backXy)) + (p.hi.y - backXy)) + ((xy - (sum - back)) + (p.hi.z - back)) +
                       (p.lo.x + p.lo.y + p.lo.z);
  precise float hi = sum + rest;
  precise float lo = rest - (hi - sum);
  return vec2(hi, lo);
}

// Rounded to float. The error is little more than half a unit in the last place, however the driver divides.
vec3 pairsOver(Pairs a, vec2 b) {
  precise vec3 quotient = a.hi / b.x;
  precise vec3 product = quotient * b.x;
  precise vec3 rest = ((a.hi - product) - productRest(quotient, vec3(b.x), product)) + (a.lo - quotient * b.y);
  precise vec3 result = quotient + rest / b.x;
  return result;
}

float largestOf(vec3 v) { return max(abs(v.x), max(abs(v.y), abs(v.z))); }

// The power of two that scales v > 0 into [1, 2).
float inversePowerOfTwo(float v) {
  return uintBitsToFloat(0x7f000000u - clamp(floatBitsToUint(v) & 0x7f800000u, 0x00800000u, 0x7e800000u));
}
