// Faces in their colour; edges of the mesh in one of their own, blended by hand with what a face would have had.
flat in vec3 shown;
uniform vec4 edge;  // colour, and how much of it
layout(location = 0) out vec4 displayColor;

void main() { displayColor = vec4(mix(shown, edge.rgb, edge.a), 1.0); }
