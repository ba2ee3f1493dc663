// Size of the table of a coat's reflectance (lib/coat.glsl), in texels; the first and last lie on the range's ends.
#pragma once

#define COAT_COSINES 64
#define COAT_ALPHAS 32     // of the square root of alpha
#define COAT_LEAST_ALPHA 1e-3  // a coat's: the lobe of a lamp of no size stays finite
