// Share of the finer of two cascades, t along the way from the end of its reach: the curve along which what is shown
// changes least, relative to itself, where one cascade is kApart times as bright as the other, whichever it is. So its
// slope is proportional to what is shown at least, 1 + (kApart - 1) min(share, 1 - share).
float blendCurve(float t) {
  const float kApart = 4.0, kHalfway = 0.5 * (kApart + 1.0);
  float fromEnd = (pow(kHalfway, 2.0 * min(t, 1.0 - t)) - 1.0) / (kApart - 1.0);
  return t < 0.5 ? fromEnd : 1.0 - fromEnd;
}

// How far a point is inside a cascade of records: 1 near the camera, 0 where the cascade has faded out. It depends on
// the distance from the camera alone: were it to follow the grid, which is pushed along the view, then every turn of
// the camera would change what all surfaces show. What is in view is within the grid as far as the cascade reaches
// (placeCascadesAround); behind the camera the grid's own border ends it, over one cell. Needs cascades/block.glsl.
float cacheCascadeWeight(int k, vec3 position) {
  if (k + 1 == grids.shape.y) return 1.0;  // outside its grid the coarsest has no records
  CascadeGrid cascade = grids.cascades[k];
  vec3 place = (position - cascade.minimum) / cascade.cellSize,
       fromBorder = min(place, float(grids.shape.x) - place);
  float inside = clamp(min(fromBorder.x, min(fromBorder.y, fromBorder.z)) - 0.5, 0.0, 1.0);
  float rest = cascade.blendHalf - distance(position, cascade.blendCentre);
  return inside * blendCurve(clamp(rest / (grids.blendBand * cascade.blendHalf), 0.0, 1.0));
}
