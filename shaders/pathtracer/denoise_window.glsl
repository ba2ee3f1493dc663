// The window over which terms are summed: a Gaussian, cut off.
const int kWindow = 9;
const float kWindowWidth = 4.5;  // standard deviation, pixels
float windowAt(int offset) { return exp(-float(offset * offset) / (2.0 * kWindowWidth * kWindowWidth)); }
