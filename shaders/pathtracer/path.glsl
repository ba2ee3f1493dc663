// The path that a lane follows: where it is, what it carries, how it starts, and how it waits for the next submission.
// path.comp says what its throughput is.

layout(std430, binding = 5) restrict buffer StateBlock {
  uint unfinished;      // pixels of the tile that do not have their samples yet
  uint leakedPaths;     // ended, since they were found outside of the scene, yet inside of a closed boundary
  uint wrongCrossings;  // of boundaries left without having been entered: open or turned meshes
  uint longest;         // turns of loops that a lane took
  // and that all lanes took; below 2^32, as a submission has no more than 2^28 but for the last segments
  uint allTurns;
  uint collisions;      // in media, of all lanes
  uvec4 state[];        // STATE_WORDS a lane, lane by lane within each
};

struct Path {
  vec3 origin;
  uint skip;            // triangle that the ray starts on
  vec3 direction;       // unit
  // density with which it was sampled, 1/sr; 0 where nothing else could have: camera and smooth surfaces
  float pdf;
  vec3 throughput;
  float travelled;      // since the last scattering, along boundaries that change nothing
  vec3 radiance;
  uint scatterings;     // up to here
  uint event;           // place in the sequence of random numbers: one a surface or medium met
  float ior;            // of where the ray is
  uint chain;           // smooth scatterings in a row up to here
#if INTERIORS
  uvec4 inside;         // of which closed boundaries (boundary.glsl)
  // length of the ray before its origin, which lies a little beside a surface; negative: what the origin is too early
  float head;
  uint face;            // that surface, where head is not 0
#endif
};

// Throughput below which roulette begins. In media many weak scatterings make up what is seen, and dying at each of
// them costs more in noise than it saves in time: a slab of albedo 0.5 needs a third of the time for the same error
// with 1/4 as with 1.
#if MEDIA
const float kRouletteBelow = 0.25;
#else
const float kRouletteBelow = 1.0;
#endif

const uint kInFlight = 0x80000000u;  // in the saved event: there is a path to be gone on with

bool counts(uint scatterings) { return scatterings >= tracer.minScatterings && scatterings <= tracer.maxScatterings; }

#if INTERIORS
uniform uvec4 cameraInside;  // of which closed boundaries the camera is
uniform float cameraIor;     // and the index of refraction there
#endif

// What a light adds where the path now is.
vec3 lightOf(Path path, vec3 light) {
#if DIELECTRICS
  light *= cameraIor * cameraIor / (path.ior * path.ior);
#endif
  return path.throughput * light;
}
void addLight(inout Path path, vec3 light) { path.radiance += lightOf(path, light); }

Path startPath(ivec2 pixel, PathNumbers numbers) {
#if PIXEL_CENTRES
  vec2 place = vec2(pixel) + 0.5;
#else
  vec2 place = vec2(pixel) + randomPair(numbers, 0u, kPurposeFilm);
#endif
  Path path;
  path.origin = tracer.cameraPosition;
  path.skip = kNoHit;
  path.direction = normalize(tracer.firstPixel + place.x * tracer.pixelRight + place.y * tracer.pixelUp);
  path.pdf = 0.0;
  path.throughput = vec3(1.0);
  path.travelled = 0.0;
  path.radiance = vec3(0.0);
  path.scatterings = 0u;
  path.event = 0u;
  path.ior = 1.0;
  path.chain = 0u;
#if INTERIORS
  path.inside = cameraInside;
  path.head = 0.0;
  path.face = 0u;
  path.ior = cameraIor;
#endif
  return path;
}

// A lane's place in `state`.
struct Lane {
  uint slot;
  uint count;  // of all lanes
};

// The path that waits, if there is one.
bool restorePath(Lane lane, out Path path) {
  uvec4 saved = state[lane.slot + 4u * lane.count];
  if ((saved.x & kInFlight) == 0u) return false;
  uvec4 w0 = state[lane.slot], w1 = state[lane.slot + lane.count];
  uvec4 w2 = state[lane.slot + 2u * lane.count], w3 = state[lane.slot + 3u * lane.count];
  path = Path(uintBitsToFloat(w0.xyz), w0.w, uintBitsToFloat(w1.xyz), uintBitsToFloat(w1.w), uintBitsToFloat(w2.xyz),
              uintBitsToFloat(w2.w), uintBitsToFloat(w3.xyz), w3.w & 0xffffffu, saved.x & ~kInFlight,
              uintBitsToFloat(saved.y), w3.w >> 24u
#if INTERIORS
              ,
              state[lane.slot + 5u * lane.count], uintBitsToFloat(saved.z), saved.w
#endif
  );
  return true;
}

void savePath(Lane lane, Path path, bool inFlight) {
  state[lane.slot + 4u * lane.count] = uvec4(inFlight ? path.event | kInFlight : 0u, floatBitsToUint(path.ior),
#if INTERIORS
                                             floatBitsToUint(path.head), path.face);
#else
                                             0u, 0u);
#endif
  if (!inFlight) return;
  state[lane.slot] = uvec4(floatBitsToUint(path.origin), path.skip);
  state[lane.slot + lane.count] = uvec4(floatBitsToUint(path.direction), floatBitsToUint(path.pdf));
  state[lane.slot + 2u * lane.count] = uvec4(floatBitsToUint(path.throughput), floatBitsToUint(path.travelled));
  state[lane.slot + 3u * lane.count] =
      uvec4(floatBitsToUint(path.radiance), min(path.scatterings, 0xffffffu) | path.chain << 24u);
#if INTERIORS
  state[lane.slot + 5u * lane.count] = path.inside;
#endif
  atomicAdd(unfinished, 1u);
}

#if MEDIA
// In media a ray starts nearer to its surface than elsewhere, 8 units in the last place of the triangle's largest
// coordinate, as what lies between may be a good part of a mean free path; and the flight through it is counted.
const float kBeside = 4.76837158203125e-7;  // 2^-21
#endif

// How far beside a surface rays start that leave it.
float gapAt(Surface surface) {
#if FIXED_EPSILON
  return 1e-3;  // scene units, whatever the scene's size [VPT2024]
#elif MEDIA
  return surface.magnitude * kBeside;
#else
  return surface.magnitude * 3.814697265625e-6;  // as offsetRay
#endif
}

// Where a ray starts that leaves a surface towards the side of `normal`.
vec3 beside(Surface surface, vec3 normal) { return surface.position + normal * gapAt(surface); }

// Starts the path's next ray on a surface.
void startAt(inout Path path, Surface surface, uint triangle) {
  float cosine = dot(path.direction, surface.geometricNormal);
  path.origin = beside(surface, cosine > 0.0 ? surface.geometricNormal : -surface.geometricNormal);
  path.skip = triangle;
#if MEDIA
  path.head = surface.magnitude * kBeside / max(abs(cosine), 0.01);
  path.face = triangle;
#endif
}
