// Trilinear reading of one cascade out of a stack: x and y end in the sampler's border of zeros, z by hand.
struct StackedTexel {
  vec3 uvw;
  float border;
};

StackedTexel stackedTexel(vec3 texel, int index) {
  float n = float(lpv.shape.x);
  float border = clamp(min(texel.z, n - texel.z) + 0.5, 0.0, 1.0);
  texel.z = clamp(texel.z, 0.5, n - 0.5) + float(index) * n;
  return StackedTexel(texel / vec3(n, n, n * float(lpv.shape.y)), border);
}

// Where a point of a cascade, in its cells, lies in the next coarser one.
vec3 lpvCoarserTexel(vec3 texel, int cascade) {
  vec3 position = lpv.cascades[cascade].minimum + texel * lpv.cascades[cascade].cellSize;
  return (position - lpv.cascades[cascade + 1].minimum) / lpv.cascades[cascade + 1].cellSize;
}
