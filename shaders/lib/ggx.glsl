// Trowbridge-Reitz (GGX) microfacets with height-correlated shadowing [Walter2007], [Heitz2014]. Directions in the
// surface's frame, z along the normal, unit and away from the surface. Needs kPi.

// Distribution of facet normals per unit of projected area and solid angle; computed by components, since 1 - z^2 would
// cancel for small alpha.
float ggxDensity(vec3 h, float alpha) {
  float a2 = alpha * alpha, t = dot(h.xy, h.xy) / a2 + h.z * h.z;
  return 1.0 / (kPi * a2 * t * t);
}

// Shadowing: G1 = 1 / (1 + lambda), G2 = 1 / (1 + lambda_o + lambda_i).
float ggxLambda(vec3 w, float alpha) { return 0.5 * (sqrt(1.0 + alpha * alpha * dot(w.xy, w.xy) / (w.z * w.z)) - 1.0); }

// A facet's normal as seen from `o` (o.z > 0), density G1(o) D(h) max(0, o.h) / o.z [DupuyBenyoub2023].
vec3 ggxSample(vec3 o, float alpha, vec2 xi) {
  vec3 stretched = normalize(vec3(alpha * o.xy, o.z));
  float z = (1.0 - xi.y) * (1.0 + stretched.z) - stretched.z, r = sqrt(max(0.0, (1.0 - z) * (1.0 + z))),
        angle = 2.0 * kPi * xi.x;
  vec3 h = vec3(r * cos(angle), r * sin(angle), z) + stretched;
  return normalize(vec3(alpha * h.xy, max(h.z, 1e-7)));
}

vec3 schlick(vec3 f0, float cosine) {
  float m = 1.0 - cosine, m2 = m * m;
  return f0 + (1.0 - f0) * (m2 * m2 * m);
}

// Reflection by facets of reflectance 1: BSDF times the cosine of i, and the density of sampling i from o. 0 unless
// both are above the surface.
float ggxReflect(vec3 o, vec3 i, float alpha, out float pdf) {
  pdf = 0.0;
  if (!(o.z > 0.0 && i.z > 0.0)) return 0.0;
  vec3 h = normalize(o + i);
  float lambda = ggxLambda(o, alpha), common_ = ggxDensity(h, alpha) / (4.0 * o.z);
  pdf = common_ / (1.0 + lambda);
  return common_ / (1.0 + lambda + ggxLambda(i, alpha));
}

// Refraction by facets of transmittance 1, i below the surface: the same quantities, for radiance over n^2 (which a
// boundary conserves).
// eta: index on o's side over that below, not 1 [Walter2007 eq 17, 21]. h: the facet's normal, on o's side.
float ggxRefract(vec3 o, vec3 i, float alpha, float eta, out vec3 h, out float pdf) {
  pdf = 0.0;
  h = normalize(eta * o + i);
  if (h.z < 0.0) h = -h;
  float oh = dot(o, h), ih = dot(i, h);
  if (!(o.z > 0.0 && i.z < 0.0 && oh > 0.0 && ih < 0.0)) return 0.0;
  float sum = eta * oh + ih, lambda = ggxLambda(o, alpha);
  float common_ = ggxDensity(h, alpha) * oh * -ih / (o.z * sum * sum);
  pdf = common_ / (1.0 + lambda);
  return common_ / (1.0 + lambda + ggxLambda(i, alpha));
}
