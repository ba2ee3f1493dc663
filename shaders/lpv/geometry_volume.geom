// Blocking potential [Kaplanyan2010, section 4.2]: a surfel of area A and normal n adds A / s^2 * lobe(n) to its cell
// of the geometry volume. That volume is shifted by half a cell, so that its cell centres lie on the grid's corners. A
// is the surface's true area, which the reflective shadow map stores next to the flux.
#include "lib/sh.glsl"
#include "cascades/block.glsl"
#include "lpv/surfel.glsl"
layout(points) in;
layout(points, max_vertices = MAX_CASCADES) out;
in vec4 gPosition[];
in vec4 gNormal[];
in vec4 gFlux[];  // w = area
flat out vec4 fPotential;
#if REFLECTS
in vec3 gAlbedo[];
flat out vec3 fReflectance;
#endif
#if SURFEL_AREA
uniform vec3 lightPosition;
uniform float texelCount;  // 0: a perspective light, which has true areas
#endif

void main() {
  vec3 normal = gNormal[0].xyz;
  if (!isUsableSurfel(gPosition[0], normal, gFlux[0].w)) return;
  int corners = grids.shape.x + 1;
  float area = gFlux[0].w;
#if SURFEL_AREA
  // Deviation lpv.surfel-area: uses the formula of a 90 degree perspective light, weighted by N.L, for an orthographic
  // one.
  vec3 away = gPosition[0].xyz - lightPosition;
  if (texelCount > 0.0) area = 4.0 * dot(away, away) / texelCount * gNormal[0].w;
#endif
  for (int k = 0; k < grids.shape.y; ++k) {
    float s = grids.cascades[k].cellSize;
    ivec3 corner;
    if (!surfelCorner(k, gPosition[0].xyz, corner)) continue;
    fPotential = area / (s * s) * shCosineLobe(normal);
#if REFLECTS
    fReflectance = area / (s * s) * gAlbedo[0];
#endif
    gl_Layer = k * corners + corner.z;
    gl_Position = vec4((vec2(corner.xy) + 0.5) / float(corners) * 2.0 - 1.0, 0.0, 1.0);
    gl_PointSize = 1.0;
    EmitVertex();
    EndPrimitive();
  }
}
