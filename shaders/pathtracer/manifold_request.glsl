// A path's request to manifold.comp at a scattering vertex: light of a lamp by way of refracting boundaries and
// mirrors. It waits in the lane's last words of the state buffer, and its path with it.
const uint kManifoldWord = uint(STATE_WORDS) - 8u;

const uint kPurposeWay = kFreePurpose + 6u;

const uint kManifoldDone = 0u, kManifoldFirst = 1u, kManifoldTrials = 2u;

struct ManifoldRequest {
  vec3 position;      // of the vertex, in a medium
  uint triangle;      // of the vertex, on a surface; kNoHit in a medium
  vec3 incoming;      // the direction in which the path arrived
  uint event;
  vec3 throughput;    // before the vertex
  uint scatterings;   // the vertex included
  vec2 barycentrics;
  float ior;          // at the vertex
  uint status;
  uvec4 inside;       // the closed boundaries that contain the vertex
  vec3 found;         // direction of the first solution
  uint trials;        // to find it again, so far
  vec3 contribution;  // of that solution
  uint steps;         // of Newton's method, from the current seed
  vec3 direction;     // from the vertex; where Newton's method is
};

uint manifoldStatus() { return state[wordAt(kManifoldWord + 3u)].w; }

ManifoldRequest restoreManifold() {
  uvec4 w[8];
  for (uint i = 0u; i < 8u; ++i) w[i] = state[wordAt(kManifoldWord + i)];
  return ManifoldRequest(uintBitsToFloat(w[0].xyz), w[0].w, uintBitsToFloat(w[1].xyz), w[1].w,
                         uintBitsToFloat(w[2].xyz), w[2].w, uintBitsToFloat(w[3].xy), uintBitsToFloat(w[3].z), w[3].w,
                         w[4], uintBitsToFloat(w[5].xyz), w[5].w, uintBitsToFloat(w[6].xyz), w[6].w,
                         uintBitsToFloat(w[7].xyz));
}

void saveManifold(ManifoldRequest r) {
  state[wordAt(kManifoldWord)] = uvec4(floatBitsToUint(r.position), r.triangle);
  state[wordAt(kManifoldWord + 1u)] = uvec4(floatBitsToUint(r.incoming), r.event);
  state[wordAt(kManifoldWord + 2u)] = uvec4(floatBitsToUint(r.throughput), r.scatterings);
  state[wordAt(kManifoldWord + 3u)] = uvec4(floatBitsToUint(r.barycentrics), floatBitsToUint(r.ior), r.status);
  state[wordAt(kManifoldWord + 4u)] = r.inside;
  state[wordAt(kManifoldWord + 5u)] = uvec4(floatBitsToUint(r.found), r.trials);
  state[wordAt(kManifoldWord + 6u)] = uvec4(floatBitsToUint(r.contribution), r.steps);
  state[wordAt(kManifoldWord + 7u)] = uvec4(floatBitsToUint(r.direction), 0u);
}

// Whether a path seeks a lamp at its current vertex, before it scatters there. Only lamps that rays never find are
// sought: points, spots and the sun.
bool seeksWay(Path path, float probability, PathNumbers numbers) {
  if (path.scatterings + 1u > tracer.maxScatterings || path.throughput == vec3(0.0) ||
      !(unitFloat(randomWords(numbers, path.event, kPurposeWay).w) < probability))
    return false;
  uint kind = lights[pick(randomWords(numbers, path.event, kPurposePick))].kind;
  return kind != PATH_LIGHT_TRIANGLE && kind != PATH_LIGHT_ENVIRONMENT;
}

// Writes down its request.
void requestManifold(Path path, uint triangle, vec2 barycentrics, float probability, PathNumbers numbers) {
  if (!seeksWay(path, probability, numbers)) return;
#if INTERIORS
  uvec4 inside = path.inside;
#else
  const uvec4 inside = uvec4(0u);
#endif
  saveManifold(ManifoldRequest(path.origin, triangle, path.direction, path.event, path.throughput / probability,
                               path.scatterings, barycentrics, path.ior, kManifoldFirst, inside, vec3(0.0), 0u,
                               vec3(0.0), 0u, vec3(0.0)));
}
