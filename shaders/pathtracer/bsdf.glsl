// The surface that a path meets: its BSDF, evaluated and sampled.

// The scattering properties at a path's hit. Lambert, coated or not: `albedo` is the base's reflectance; mirrors and
// conductors: the reflectance at normal incidence.
struct Bsdf {
  uint kind;
  vec3 albedo;
  float roughness;
  float eta;       // dielectrics: index on the path's side over that on the other
  vec3 normal;     // for shading, on the path's side
#if COATS
  Coat coat;
#endif
};

// A Lambertian base, with or without a coat.
bool isOpaque(Bsdf bsdf) {
#if COATS
  return bsdf.kind == PATH_DIFFUSE || bsdf.kind == PATH_COATED;
#else
  return bsdf.kind == PATH_DIFFUSE;
#endif
}

bool isSmooth(Bsdf bsdf) {
#if GLOSSY
  return bsdf.kind == PATH_MIRROR || (!isOpaque(bsdf) && bsdf.roughness == 0.0);
#else
  return !isOpaque(bsdf);
#endif
}

// The surface that a path has met; iorBeyond: refractive index behind it.
Bsdf bsdfOf(Path path, Surface surface, PathMaterial material, float iorBeyond) {
  Bsdf bsdf = Bsdf(material.kind, material.specular, material.roughness, 1.0, surface.normal
#if COATS
                   , Coat(vec3(0.0), 1.0)
#endif
  );
  if (isOpaque(bsdf)) bsdf.albedo = DIFFUSE_ONLY != 0 ? wholeAlbedoAt(surface) : albedoAt(surface);
  // For a path that sees the back of the shading normal, mirrors and glass use the geometric normal.
  else if (!(dot(surface.normal, path.direction) < 0.0)) bsdf.normal = surface.geometricNormal;
#if COATS
  if (bsdf.kind == PATH_COATED) bsdf.coat = coatAt(surface);
#endif
#if DIELECTRICS
  if (bsdf.kind == PATH_DIELECTRIC) bsdf.eta = path.ior / iorBeyond;
#endif
  return bsdf;
}

#if COATS
// Probability with which scatter() samples the coat rather than the base: by what they reflect. 0 where the shading
// normal faces away from the path.
float coatShare(Bsdf bsdf, float cosine) {
  if (!(cosine > 0.0)) return 0.0;
  vec3 coat = coatAlbedo(bsdf.coat, cosine), base = bsdf.albedo * (1.0 - coat);
  float most = max(coat.x, max(coat.y, coat.z)), rest = max(base.x, max(base.y, base.z));
  return rest > 0.0 ? clamp(most / (most + rest), 0.1, 0.9) : 1.0;
}

// evaluate() of a coated surface; share: coatShare of `o`.
vec3 evaluateCoated(Bsdf bsdf, vec3 o, vec3 i, float share, out float pdf) {
  vec3 t, b;
  tangentFrame(bsdf.normal, t, b);
  vec3 lo = vec3(dot(o, t), dot(o, b), dot(o, bsdf.normal)), li = vec3(dot(i, t), dot(i, b), dot(i, bsdf.normal));
  float facetsPdf, facets = ggxReflect(lo, li, bsdf.coat.alpha, facetsPdf), lambert = max(li.z, 0.0) / kPi;
  pdf = mix(lambert, facetsPdf, share);
  vec3 value = bsdf.albedo * coatTransmission(bsdf.coat, lo.z, li.z) * lambert;
  if (facets > 0.0) value += facets * coatFresnel(bsdf.coat, clamp(dot(o, normalize(o + i)), 0.0, 1.0));
  return value;
}
#endif

// BSDF times the cosine of `i`, and the density with which scatter() draws `i`; not for smooth surfaces. `o` and `i`
// point away from the surface.
vec3 evaluate(Bsdf bsdf, vec3 o, vec3 i, out float pdf) {
#if COATS
  if (bsdf.kind == PATH_COATED) return evaluateCoated(bsdf, o, i, coatShare(bsdf, dot(o, bsdf.normal)), pdf);
#endif
#if GLOSSY
  if (bsdf.kind != PATH_DIFFUSE) {
    vec3 t, b;
    tangentFrame(bsdf.normal, t, b);
    vec3 lo = vec3(dot(o, t), dot(o, b), dot(o, bsdf.normal)), li = vec3(dot(i, t), dot(i, b), dot(i, bsdf.normal));
#if ROUGH_DIELECTRICS
    if (bsdf.kind == PATH_CONDUCTOR)
#endif
      return ggxReflect(lo, li, bsdf.roughness, pdf) * schlick(bsdf.albedo, max(dot(lo, normalize(lo + li)), 0.0));
#if ROUGH_DIELECTRICS
    float cosT, share;
    vec3 h = normalize(lo + li);
    float value =
        li.z > 0.0 ? ggxReflect(lo, li, bsdf.roughness, pdf) : ggxRefract(lo, li, bsdf.roughness, bsdf.eta, h, pdf);
    float reflectance = fresnelDielectric(clamp(dot(lo, h), 0.0, 1.0), bsdf.eta, cosT);
    share = li.z > 0.0 ? reflectance : 1.0 - reflectance;
    pdf *= share;
    return vec3(value * share);
#endif
  }
#endif
  float cosine = max(dot(i, bsdf.normal), 0.0);
  pdf = cosine / kPi;
  return bsdf.albedo * pdf;
}

// Draws a direction: multiplies the throughput by BSDF cos / density and sets direction and density (0 for smooth
// surfaces). False: absorbed.
bool scatter(inout Path path, Bsdf bsdf, vec3 geometricNormal, vec2 xi, float choice) {
  if (bsdf.kind == PATH_DIFFUSE) {
    path.direction = cosineSample(bsdf.normal, xi);
    path.pdf = dot(path.direction, bsdf.normal) / kPi;
    path.throughput *= bsdf.albedo;
    return dot(path.direction, geometricNormal) > 0.0;
  }
  vec3 o = -path.direction;
#if COATS
  if (bsdf.kind == PATH_COATED) {
    float share = coatShare(bsdf, dot(o, bsdf.normal));
    if (choice < share) {
      vec3 t, b;
      tangentFrame(bsdf.normal, t, b);
      vec3 h = ggxSample(vec3(dot(o, t), dot(o, b), dot(o, bsdf.normal)), bsdf.coat.alpha, xi);
      h = normalize(h.x * t + h.y * b + h.z * bsdf.normal);
      path.direction = normalize(2.0 * dot(o, h) * h - o);
    } else {
      path.direction = cosineSample(bsdf.normal, xi);
    }
    vec3 value = evaluateCoated(bsdf, o, path.direction, share, path.pdf);
    if (!(path.pdf > 0.0)) return false;
    path.throughput *= value / path.pdf;
    return dot(path.direction, geometricNormal) > 0.0;
  }
#endif
  vec3 h = bsdf.normal;
  path.pdf = 0.0;
#if GLOSSY
  bool rough = bsdf.roughness > 0.0 && bsdf.kind != PATH_MIRROR;
  vec3 t = vec3(0.0), b = vec3(0.0), lo = vec3(0.0);
  if (rough) {
    tangentFrame(bsdf.normal, t, b);
    lo = vec3(dot(o, t), dot(o, b), dot(o, bsdf.normal));
    vec3 lh = ggxSample(lo, bsdf.roughness, xi);
    h = normalize(lh.x * t + lh.y * b + lh.z * bsdf.normal);
  }
#endif
  float cosI = clamp(dot(o, h), 0.0, 1.0), cosT = 0.0;
  bool reflects = true;
  float share = 1.0;  // probability of the chosen way, reflection or refraction
#if DIELECTRICS
  if (bsdf.kind == PATH_DIELECTRIC) {
    float reflectance = fresnelDielectric(cosI, bsdf.eta, cosT);
    reflects = choice < reflectance;
    share = reflects ? reflectance : 1.0 - reflectance;
  }
#endif
  vec3 scattered = reflects ? 2.0 * cosI * h - o : (bsdf.eta * cosI - cosT) * h - bsdf.eta * o;
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
    vec3 li = vec3(dot(path.direction, t), dot(path.direction, b), dot(path.direction, bsdf.normal)), ignored;
    if (reflects ? li.z <= 0.0 : li.z >= 0.0) return false;
    float value = reflects ? ggxReflect(lo, li, bsdf.roughness, path.pdf)
                           : ggxRefract(lo, li, bsdf.roughness, bsdf.eta, ignored, path.pdf);
    if (!(path.pdf > 0.0)) return false;
    path.throughput *= value / path.pdf;
    path.pdf *= share;
  }
  if (bsdf.kind == PATH_CONDUCTOR) path.throughput *= schlick(bsdf.albedo, cosI);
#endif
#if MIRRORS
  if (bsdf.kind == PATH_MIRROR) path.throughput *= bsdf.albedo;
#endif
  return true;
}
