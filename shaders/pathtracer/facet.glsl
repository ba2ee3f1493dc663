// The surface that a path meets: its BSDF, evaluated and sampled.

// The scattering properties at a path's hit. Lambert: `albedo` is the reflectance; mirrors and conductors: the
// reflectance at normal incidence.
struct Facet {
  uint kind;
  vec3 albedo;
  float roughness;
  float eta;       // dielectrics: index on the path's side over that on the other
  vec3 normal;     // for shading, on the path's side
};

bool isSmooth(Facet facet) {
#if GLOSSY
  return facet.kind == PATH_MIRROR || (facet.kind != PATH_DIFFUSE && facet.roughness == 0.0);
#else
  return facet.kind != PATH_DIFFUSE;
#endif
}

// BSDF times the cosine of `i`, and the density with which scatter() draws `i`; not for smooth surfaces. `o` and `i`
// point away from the surface.
vec3 evaluate(Facet facet, vec3 o, vec3 i, out float pdf) {
#if GLOSSY
  if (facet.kind != PATH_DIFFUSE) {
    vec3 t, b;
    tangentFrame(facet.normal, t, b);
    vec3 lo = vec3(dot(o, t), dot(o, b), dot(o, facet.normal)), li = vec3(dot(i, t), dot(i, b), dot(i, facet.normal));
#if ROUGH_DIELECTRICS
    if (facet.kind == PATH_CONDUCTOR)
#endif
      return ggxReflect(lo, li, facet.roughness, pdf) * schlick(facet.albedo, max(dot(lo, normalize(lo + li)), 0.0));
#if ROUGH_DIELECTRICS
    float cosT, share;
    vec3 h = normalize(lo + li);
    float value =
        li.z > 0.0 ? ggxReflect(lo, li, facet.roughness, pdf) : ggxRefract(lo, li, facet.roughness, facet.eta, h, pdf);
    float reflectance = fresnelDielectric(clamp(dot(lo, h), 0.0, 1.0), facet.eta, cosT);
    share = li.z > 0.0 ? reflectance : 1.0 - reflectance;
    pdf *= share;
    return vec3(value * share);
#endif
  }
#endif
  float cosine = max(dot(i, facet.normal), 0.0);
  pdf = cosine / kPi;
  return facet.albedo * pdf;
}

// Draws a direction: multiplies the throughput by BSDF cos / density and sets direction and density (0 for smooth
// surfaces). False: absorbed.
bool scatter(inout Path path, Facet facet, vec3 geometricNormal, vec2 xi, float choice) {
  if (facet.kind == PATH_DIFFUSE) {
    path.direction = cosineSample(facet.normal, xi);
    path.pdf = dot(path.direction, facet.normal) / kPi;
    path.throughput *= facet.albedo;
    return dot(path.direction, geometricNormal) > 0.0;
  }
  vec3 o = -path.direction;
  vec3 h = facet.normal;
  path.pdf = 0.0;
#if GLOSSY
  bool rough = facet.roughness > 0.0 && facet.kind != PATH_MIRROR;
  vec3 t = vec3(0.0), b = vec3(0.0), lo = vec3(0.0);
  if (rough) {
    tangentFrame(facet.normal, t, b);
    lo = vec3(dot(o, t), dot(o, b), dot(o, facet.normal));
    vec3 lh = ggxSample(lo, facet.roughness, xi);
    h = normalize(lh.x * t + lh.y * b + lh.z * facet.normal);
  }
#endif
  float cosI = clamp(dot(o, h), 0.0, 1.0), cosT = 0.0;
  bool reflects = true;
  float share = 1.0;  // probability of the chosen way, reflection or refraction
#if DIELECTRICS
  if (facet.kind == PATH_DIELECTRIC) {
    float reflectance = fresnelDielectric(cosI, facet.eta, cosT);
    reflects = choice < reflectance;
    share = reflects ? reflectance : 1.0 - reflectance;
  }
#endif
  vec3 scattered = reflects ? 2.0 * cosI * h - o : (facet.eta * cosI - cosT) * h - facet.eta * o;
  float side = dot(scattered, geometricNormal);
  if (reflects ? side <= 0.0 : side >= 0.0) {  // the shading normal sends the direction to the wrong side of the face
#if GLOSSY
    if (rough) return false;
#endif
    scattered = reflects ? 2.0 * dot(o, geometricNormal) * geometricNormal - o : -o;
  }
  path.direction = normalize(scattered);
#if GLOSSY
  if (rough) {
    vec3 li = vec3(dot(path.direction, t), dot(path.direction, b), dot(path.direction, facet.normal)), ignored;
    if (reflects ? li.z <= 0.0 : li.z >= 0.0) return false;
    float value = reflects ? ggxReflect(lo, li, facet.roughness, path.pdf)
                           : ggxRefract(lo, li, facet.roughness, facet.eta, ignored, path.pdf);
    if (!(path.pdf > 0.0)) return false;
    path.throughput *= value / path.pdf;
    path.pdf *= share;
  }
  if (facet.kind == PATH_CONDUCTOR) path.throughput *= schlick(facet.albedo, cosI);
#endif
#if MIRRORS
  if (facet.kind == PATH_MIRROR) path.throughput *= facet.albedo;
#endif
  return true;
}
