// Radiance of the volume's light at a point, as two bands per channel.
//
// Radiance Y00 l0 + Y1 <l1, w> of light that travels along w gives a plane the irradiance pi Y00 l0 + 2 pi / 3 Y1
// <l1, -n>, and coefficients c give it a0 c0 + a1 <c1, -n> (lpv/lookup.glsl, FLUX_LOOKUP). So the radiance that carries
// the flux of the kernel and the lookup has l0 = 2/3 c0 and l1 = 3 / (2 pi) (Omega_f + 8 Omega_s / sqrt 5) c1.
#include "lpv/lookup.glsl"

// Columns red, green, blue: (l0, l1), W per square scene unit and sr, over E_ref.
mat3x4 lpvRadiance(vec3 position) {
  const vec4 kBands = vec4(2.0 / 3.0, vec3(0.91461886));
  mat3x4 sum = mat3x4(0.0);
  float left = 1.0;
  for (int k = 0; k < grids.shape.y && left > 0.0; ++k) {
#if SUM_CASCADES
    float weight = 1.0;
#else
    float weight = left * cascadeWeight(k, position);
    left -= weight;
    if (weight <= 0.0) continue;
#endif
    float border;
    float cells = float(grids.shape.x);
    vec3 place = lpvPlace(k, position, vec3(0.0), border) / vec3(cells, cells, cells * float(grids.shape.y));
    sum += weight * border *
           mat3x4(textureLod(lpvRed, place, 0.0), textureLod(lpvGreen, place, 0.0), textureLod(lpvBlue, place, 0.0));
  }
  return mat3x4(kBands * sum[0], kBands * sum[1], kBands * sum[2]);
}
