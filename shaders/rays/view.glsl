// The ray through a place of the picture, in pixels from its lower left corner. Needs the path constants.
void viewRay(vec2 place, out vec3 origin, out vec3 direction) {
  origin = tracer.cameraPosition;
  if (tracer.isOrthographic != 0) {
    vec2 fromCentre = place - 0.5 * vec2(tracer.picture.xy);
    origin += fromCentre.x * tracer.pixelRight + fromCentre.y * tracer.pixelUp;
    direction = tracer.firstPixel;
  } else {
    direction = normalize(tracer.firstPixel + place.x * tracer.pixelRight + place.y * tracer.pixelUp);
  }
}
