// Delta form factors as whole numbers: sums by atomics that do not depend on the order. A hemisphere is 2^31, so a sum fits and the smallest
// of 64 x 64 pixels, 2e-7, is off by 0.1 %.
#define KEPT_WHOLE 2147483648.0
