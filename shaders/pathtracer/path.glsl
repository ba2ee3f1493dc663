// The path that a lane traces: its state, how it starts, and how it waits for the next submission. path.comp defines
// its throughput.
//
// Flag STATE_WORDS: of a lane in the state buffer. SPILLED, on GPUs: what is not needed while a ray is traced, or in
// another stage, lies there instead of in registers. reload...() and spill...() do nothing otherwise.
#define SPILLED (SHARED_STACK > 0)
#define WALKING (WALKS && !INSPECTED)  // in walk.comp; an inspected pixel traces every flight
#define PARTS (SPLITS_BOUNDARIES || SPLITS_FLIGHTS)
#include "pathtracer/film_place.glsl"

layout(std430, binding = 5) restrict buffer StateBlock {
  uint leakedPaths;     // terminated because they were found outside the scene, yet inside a closed boundary
  uint wrongCrossings;  // boundaries left without having been entered: open or flipped meshes
  uint longest;         // most loop iterations of any lane
  // loop iterations of all lanes; below 2^32, since a submission has at most 2^28 plus the last segments
  uint allIterations;
  uint collisions;      // in media, over all lanes
  uint finished;        // pixels of the tile that have all their samples, since the last submission
  uint padding0, padding1;
  uint heads[6], tails[6];  // of the queues
  // STATE_WORDS a pixel: for each group of 64 pixels, word by word. With SHARES_PIXELS also the queues, one in each
  // component.
  uvec4 state[];
};

struct Path {
  vec3 origin;
  uint skip;            // triangle that the ray starts on
  vec3 direction;       // unit
  // density with which it was sampled, 1/sr; 0 if no other strategy could sample it: camera and smooth surfaces
  float pdf;
  vec3 throughput;
  float travelled;      // since the last scattering, including across boundaries that change nothing
  vec3 radiance;
  uint scatterings;     // so far
  uint event;           // index in the sequence of random numbers: one per surface or medium event
  float ior;            // at the ray's origin
  uint chain;           // smooth scatterings in a row so far
#if PARTS
  uint part;            // of its sample: kWhole ... kLast
#endif
#if INTERIORS
  uvec4 inside;         // the closed boundaries that contain the path (boundary.glsl)
  // length of the ray before its origin, which is offset from a surface; negative: the amount by which the origin is
  // too early
  float head;
  uint face;            // that surface, if head is not 0
#endif
};

// Throughput below which roulette begins. Many weak scatterings make up the picture, and roulette at each of them costs
// more in noise than it saves in time: with 1/4 compared with 1, for the same error, a slab of albedo 0.5 needs a third
// of the time; the Cornell box and the atrium 0.7 and 0.8 of it by relative error, 0.84 and 0.91 by squared error.
const float kRouletteBelow = 0.25;

const uint kMostChain = 63u;  // smooth scatterings that are counted
#if PARTS
// A sample may have two parts, one after the other: at a smooth boundary what refracts there and, from the camera anew,
// what reflects; in a thin medium what passes and what is scattered. Drawing one of them makes most of the noise where
// one is rare and bright, as a wisp of smoke, or the other dark, as coffee. kSecond: up to where they part.
const uint kWhole = 0u, kFirst = 1u, kSecond = 2u, kLast = 3u;
#endif

// In the saved event: a path is waiting to be continued; it has ended, and waits for manifold.comp, or in a walk; the
// pixel has all its samples. 0: the pixel's pass has not begun.
const uint kInFlight = 0x80000000u, kPathEnded = 0x40000000u, kFinished = 0x20000000u,
           kEventBits = 0x1fffffffu;

bool counts(uint scatterings) { return scatterings >= tracer.minScatterings && scatterings <= tracer.maxScatterings; }

#if INTERIORS
uniform uvec4 cameraInside;  // the closed boundaries that contain the camera
uniform float cameraIor;     // refractive index at the camera
#endif

// A light's contribution at the path's current position.
vec3 lightOf(Path path, vec3 light) {
#if DIELECTRICS && !UNSCALED_REFRACTION  // [VPT2024, 5.7] adds what is found as it is
  light *= cameraIor * cameraIor / (path.ior * path.ior);
#endif
  return path.throughput * light;
}

Path startPath(ivec2 pixel, PathNumbers numbers) {
  Path path;
  viewRay(filmPlace(pixel, numbers), path.origin, path.direction);
  path.skip = kNoHit;
  path.pdf = 0.0;
  path.throughput = vec3(1.0);
  path.travelled = 0.0;
  path.radiance = vec3(0.0);
  path.scatterings = 0u;
  path.event = 0u;
  path.ior = 1.0;
  path.chain = 0u;
#if PARTS
  path.part = kWhole;
#endif
#if INTERIORS
  path.inside = cameraInside;
  path.head = 0.0;
  path.face = 0u;
  path.ior = cameraIor;
#endif
  return path;
}

// A pixel's words in `state`. The path's are origin, skip; direction, pdf; throughput, travelled; radiance, scatterings
// and chain; event, ior, head, face; and with INTERIORS inside. The others are for SPILLED alone.
uint home = 0u;
const uint kShadowWord = INTERIORS != 0 ? 6u : 5u;
const uint kHitWord = 12u;      // the path's, and the boundary that a shadow ray is crossing
const uint kCoincidentWord = 14u;
uint wordAt(uint word) { return home + 64u * word; }

// 0, which compilers cannot know. Added to what stays the same, lest they compute all addresses and hashes before the
// loop and keep them in some thirty registers.
uint hiddenZero() { return SPILLED ? loopIterations >> 31u : 0u; }
void forgetAddresses() { home += hiddenZero(); }

bool isMarked(uint mark) { return (state[wordAt(4u)].x & mark) != 0u; }
void mark(uint mark) { state[wordAt(4u)].x |= mark; }

// The tile's pixels by number: groups of 8 x 8. False: beyond the tile.
bool findPixel(uint number, out ivec2 pixel) {
  uint group = number >> 6u, columns = uint(tracer.tile.z + 7) >> 3u;
  ivec2 place = ivec2(group % columns * 8u + (number & 7u), group / columns * 8u + (number >> 3u & 7u));
  home = group * 64u * uint(STATE_WORDS) + (number & 63u);
  pixel = tracer.tile.xy + place;
  return all(lessThan(place, tracer.tile.zw));
}

// The random numbers of a pixel's next sample, after `samples`. picture.w: index of the film's first sample.
uint indexOf(ivec2 pixel) { return uint(pixel.y * tracer.picture.x + pixel.x); }
PathNumbers numbersOf(ivec2 pixel, uint samples) {
  return PathNumbers(indexOf(pixel), uint(tracer.picture.w) + samples, tracer.seed);
}

// Queues of the numbers of pixels: 0 and 1 wait for path.comp, 2 and 3 for walk.comp, 4 and 5 for manifold.comp. Of
// each two, one is emptied in a round, the other one in the next round; what is added to a queue is there for the next
// kernel.
const uint kReady = 0u, kWalking = 2u, kSeeking = 4u;
#if SHARES_PIXELS
uniform uint turn;       // 0 or 1
uniform uint queueMask;  // their length less 1; a ring has room for all pixels
uint slotOf(uint queue, uint place) {
  return uint(STATE_WORDS) * uint(tracer.picture.z) + (queue >> 2u) * (queueMask + 1u) + (place & queueMask);
}

// False: the queue is empty.
bool takeFrom(uint queue, out uint number) {
  number = 0u;
  uint tail = tails[queue];
  if (heads[queue] == tail) return false;
  uint place = atomicAdd(heads[queue], 1u);
  bool isThere = int(tail - place) > 0;
  if (isThere) number = state[slotOf(queue, place)][queue & 3u];
  else atomicAdd(heads[queue], 0xffffffffu);  // another lane took the last one
  return isThere;
}

void addTo(uint queue, uint number) {
  uint slot = slotOf(queue, atomicAdd(tails[queue], 1u)), component = queue & 3u;
  if (component == 0u) state[slot].x = number;
  else if (component == 1u) state[slot].y = number;
  else if (component == 2u) state[slot].z = number;
  else state[slot].w = number;
}

#else
// Each lane has a pixel of its own, which it takes once.
const uint turn = 0u;
bool hasTaken = false;
bool takeFrom(uint queue, out uint number) {
  number = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationIndex;
  bool isFirst = !hasTaken;
  hasTaken = true;
  return isFirst;
}

void addTo(uint queue, uint number) {}
#endif

uint numberOf(uint home) { return home / (64u * uint(STATE_WORDS)) * 64u + home % (64u * uint(STATE_WORDS)); }

void restorePath(out Path path) {
  uvec4 w0 = state[wordAt(0u)], w1 = state[wordAt(1u)], w2 = state[wordAt(2u)], w3 = state[wordAt(3u)],
        w4 = state[wordAt(4u)];
  path = Path(uintBitsToFloat(w0.xyz), w0.w, uintBitsToFloat(w1.xyz), uintBitsToFloat(w1.w), uintBitsToFloat(w2.xyz),
              uintBitsToFloat(w2.w), uintBitsToFloat(w3.xyz), w3.w & 0xffffffu, w4.x & kEventBits,
              uintBitsToFloat(w4.y), w3.w >> 24u & kMostChain
#if PARTS
              ,
              w3.w >> 30u
#endif
#if INTERIORS
              ,
              state[wordAt(5u)], uintBitsToFloat(w4.z), w4.w
#endif
  );
}

// All but the radiance.
void spillPath(Path path) {
  state[wordAt(0u)] = uvec4(floatBitsToUint(path.origin), path.skip);
  state[wordAt(1u)] = uvec4(floatBitsToUint(path.direction), floatBitsToUint(path.pdf));
  state[wordAt(2u)] = uvec4(floatBitsToUint(path.throughput), floatBitsToUint(path.travelled));
#if PARTS
  uint part = path.part << 30u;
#else
  const uint part = 0u;
#endif
  state[wordAt(3u)].w = min(path.scatterings, 0xffffffu) | path.chain << 24u | part;
#if INTERIORS
  state[wordAt(4u)] =
      uvec4(path.event | kInFlight, floatBitsToUint(path.ior), floatBitsToUint(path.head), path.face);
  state[wordAt(5u)] = path.inside;
#else
  state[wordAt(4u)] = uvec4(path.event | kInFlight, floatBitsToUint(path.ior), 0u, 0u);
#endif
}

vec3 spilledRadiance() { return uintBitsToFloat(state[wordAt(3u)].xyz); }
void spillRadiance(vec3 radiance) { state[wordAt(3u)].xyz = floatBitsToUint(radiance); }

void savePath(Path path) {
  spillPath(path);
  spillRadiance(path.radiance);
}

#if SPILLED
void reload(out Path path) { restorePath(path); }
void spill(Path path) { spillPath(path); }
#if INTERIORS
void reloadHit(uint which, out Hit hit) {
  uvec4 w = state[wordAt(kHitWord + which)];
  hit = Hit(uintBitsToFloat(w.x), w.y, uintBitsToFloat(w.zw));
}
void spillHit(uint which, Hit hit) {
  state[wordAt(kHitWord + which)] = uvec4(floatBitsToUint(hit.t), hit.triangle, floatBitsToUint(hit.barycentrics));
}
#endif
vec3 radianceOf(Path path) { return spilledRadiance(); }
void startRadiance(Path path) { spillRadiance(path.radiance); }
void addRadiance(Path path, vec3 light) { spillRadiance(spilledRadiance() + light); }
#else
void reload(Path path) {}
void spill(Path path) {}
vec3 radianceOf(Path path) { return path.radiance; }
void startRadiance(Path path) {}
void addRadiance(inout Path path, vec3 light) { path.radiance += light; }
#endif
#if !SPILLED || !INTERIORS
void reloadHit(uint which, Hit hit) {}
void spillHit(uint which, Hit hit) {}
#endif

void addLight(inout Path path, vec3 light) { addRadiance(path, lightOf(path, light)); }

#if MEDIA
// In media a ray starts nearer to its surface than elsewhere, 8 units in the last place of the triangle's largest
// coordinate, because the gap may be a good part of a mean free path. The flight through the gap is accounted for.
const float kBeside = 4.76837158203125e-7;  // 2^-21
#endif

// The gap between a surface and the origin of a ray that leaves it.
float gapAt(Surface surface) {
#if FIXED_EPSILON
  return 1e-3;  // scene units, whatever the scene's size [VPT2024]
#elif MEDIA
  return surface.magnitude * kBeside;
#else
  return surface.magnitude * 3.814697265625e-6;  // as offsetRay
#endif
}

// Origin of a ray that leaves a surface towards the side of `normal`.
vec3 beside(Surface surface, vec3 normal) { return surface.position + normal * gapAt(surface); }

// Starts the path's next ray on a surface.
void startAt(inout Path path, Surface surface, uint triangle) {
  float cosine = dot(path.direction, surface.geometricNormal);
  path.origin = beside(surface, cosine > 0.0 ? surface.geometricNormal : -surface.geometricNormal);
  path.skip = triangle;
#if MEDIA
  path.head = surface.magnitude * kBeside / max(abs(cosine), 1e-4);
  path.face = triangle;
#endif
}
