// Glossy reflection of the light propagation volume.
#pragma once

#define LPV_LOBES_ANGLES 64  // texels of the table of glossy lobes
#define LPV_LOBES_ALPHAS 32
#define LPV_GLOSSY_RAYS 8  // directions of a lobe
