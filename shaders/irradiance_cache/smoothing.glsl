// Noise of records in finished pictures: a record takes the value that a plane through the records around it has in its
// place, fitted by weighted least squares [Cleveland1979]. A record counts by how likely its difference is noise, so
// what is structure stays.
uniform float pathsOfRound;

// Squared standard error of a record's irradiance, in cacheUnit(), from the scatter of its rounds of paths: an upper
// bound, since the rounds are stratified among each other (rays/random.glsl).
float squaredError(float squares, uint paths) {
  float rounds = float(paths) / pathsOfRound;
  return squares / max(rounds * (rounds - 1.0), 1.0);
}

// Of differences to the record in the middle, in cacheUnit().
struct PlaneFit {
  mat3 moments, products;  // of (1, place) with itself, and with differences
  float records;           // sum of weights
};

PlaneFit beginFit() {
  const float kSlopes = 1e-2;  // of records in one line the slope across is 0
  return PlaneFit(mat3(1.0, 0.0, 0.0, 0.0, kSlopes, 0.0, 0.0, 0.0, kSlopes), mat3(0.0), 1.0);
}

// way: from the record in the middle, in cells; axis: across which the records lie; error2: of the difference.
void addToFit(inout PlaneFit fit, vec3 way, int axis, vec3 difference, float error2, float weight) {
  const float kLikely = 2.0;
  weight *= exp(-0.5 * dot(difference, difference) / max(kLikely * error2, 1e-30));
  vec3 place = vec3(1.0, way[(axis + 1) % 3], way[(axis + 2) % 3]);
  fit.moments += weight * outerProduct(place, place);
  fit.products += weight * outerProduct(difference, place);
  fit.records += weight;
}

// The plane's difference in the middle; none where there are too few records for a plane.
vec3 fittedDifference(PlaneFit fit) {
  const float kEnoughForPlane = 3.5;
  return fit.records < kEnoughForPlane ? vec3(0.0) : (fit.products * inverse(fit.moments))[0];
}
