flat in vec4 fPotential;
layout(location = 0) out vec4 potential;
#if REFLECTS
flat in vec3 fReflectance;
layout(location = 1) out vec4 reflectance;  // albedo A / s^2, summed
#endif

void main() {
  potential = fPotential;
#if REFLECTS
  reflectance = vec4(fReflectance, 0.0);
#endif
}
