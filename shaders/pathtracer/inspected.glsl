// Records what lit the inspected pixel: every addition to a path's radiance is written down with the path's vertices
// (shared/path_tracer.h). A single lane runs, one path after the other.
uint inspectedBase() { return uint(STATE_WORDS) * uint(tracer.picture.z); }

uvec4 asPlace(vec3 place, float w) { return uvec4(floatBitsToUint(place), floatBitsToUint(w)); }

// The path's last scattering vertex, or the camera.
void notePlace(Path path) {
  if (path.scatterings >= uint(PATH_INSPECTED_PLACES)) return;
  state[inspectedBase() + 1u + path.scatterings] = asPlace(path.origin, 0.0);
}

// light: the radiance added; end: the point it comes from, or the direction to it; from: the start of the last ray.
void noteLight(Path path, PathNumbers numbers, vec3 light, uint kind, uint number, vec3 from, vec3 end,
               bool infinite) {
  if (light == vec3(0.0)) return;
  uint base = inspectedBase(), index = state[base].x, first = base + 1u + uint(PATH_INSPECTED_PLACES),
       record = first + index * uint(PATH_INSPECTED_RECORD);
  state[base].x = index + 1u;
  if (record + uint(PATH_INSPECTED_RECORD) > uint(state.length())) return;
  uint places = min(path.scatterings + 1u, uint(PATH_INSPECTED_PLACES));
  if (path.scatterings < uint(PATH_INSPECTED_PLACES)) state[base + 1u + path.scatterings] = asPlace(from, 0.0);
  state[record] = uvec4(floatBitsToUint(light), numbers.sampleIndex);
  state[record + 1u] = uvec4(path.scatterings, kind, number, places);
  for (uint i = 0u; i < uint(PATH_INSPECTED_PLACES) && i < places; ++i) state[record + 2u + i] = state[base + 1u + i];
  state[record + 2u + uint(PATH_INSPECTED_PLACES)] = asPlace(end, infinite ? 1.0 : 0.0);
}
