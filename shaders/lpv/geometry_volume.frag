flat in vec4 fPotential;
layout(location = 0) out vec4 potential;

void main() { potential = fPotential; }
