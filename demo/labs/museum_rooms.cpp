// The rooms. Figures and sources: the READMEs of engine/rsm, lpv, pathtracer and radiosity.
#include "labs/museum.hpp"

#include <array>

namespace lucerna::demo::labs {

namespace {

constexpr std::array kRooms{
    Room{"rsm.flux-cosine", "Indirect light of slanting surfaces is too dark; a plate tilted by 60 degrees reflects half.", "The cosine is in the texel's area already: the surface is larger by 1 / cos and lit less by cos.",
         "Phi = E albedo A <n, l>", "Phi = E albedo A", "A tilted plate of known flux (lab 2, task 3)", "tests/gl/lpv_deviations_test.cpp: RsmFluxCosine"},
    Room{"rsm.gather-weight", "Light near a contact is missing; a constant is shown as 2/3.", "Samples denser in the middle must be weighted by one over their density, which falls with 1 / xi alone.", "weight xi^2", "weight xi",
         "A constant map (lab 2, task 5)", "tests/gl/lpv_deviations_test.cpp: GatherWeight"},
    Room{"rsm.unbounded", "Bright dots in corners, different in every frame.", "A point light near a surface has no bound: 1 / d^2 grows without end, where the piece of surface that it stands for would not.", "Phi / pi <np, w> <n, -w> / d^2",
         "Lambert's polygon formula near a surfel", "Largest pixel and 99th percentile beside the mean", "tests/gl/lpv_deviations_test.cpp: Unbounded"},
    Room{"lpv.flux-units", "Brightness follows the map's resolution and the size of cells.", "Flux is taken a texel, not an area, and intensity is read without the cell's area.", "Phi = E albedo; 1.7 I(-n)", "Phi = E albedo A; E = <c, lobe(-n)> / s^2 and its constant",
         "Double rsm.size: four times as bright", "tests/gl/lpv_deviations_test.cpp: FluxUnits"},
    Room{"lpv.sum-cascades", "Up to three times too bright where three cascades lie over each other; a step where one ends.", "All cascades hold the same light; their sum counts it once each.", "E = E0 + E1 + E2", "blended with weights that make 1",
         "lpv.cascades=1 against 3 (lab 5, task 4)", "tests/gl/lpv_deviations_test.cpp: SumCascades"},
    Room{"lpv.unjoined", "Dark in the distance, the darker the more cascades.", "Light that travels out of a fine cascade is not handed on to the coarser one.", "each cascade propagated by itself", "far-travelled light handed over",
         "A smooth field with 1, 2 and 3 cascades", "tests/gl/lpv_deviations_test.cpp: Unjoined"},
    Room{"lpv.truncate", "Light swims while the camera moves, most where coordinates are negative.", "int() cuts towards zero, and grids are snapped to whole units instead of cells.", "int(int(x / s + 0.5) s)", "floor(x / s) s",
         "Move the scene by less than a cell (lab 5, task 1)", "tests/gl/lpv_deviations_test.cpp: Truncate"},
    Room{"lpv.first-cell", "The first layer of cells of each axis stays dark.", "Bounds are tested by > for >=.", "index > 0", "index >= 0", "A light in the first cell", "tests/gl/lpv_deviations_test.cpp: FirstCell"},
    Room{"lpv.side-directions", "Light spreads further along one axis than along the others.", "Directions to side faces are made by multiplying component by component: for some axes they collapse.", "p (a, b, 2) / sqrt 5", "(2 p + n) / sqrt 5",
         "An isotropic source: the same in all six directions (lab 4, task 4)", "tests/gl/lpv_deviations_test.cpp: SideDirections"},
    Room{"lpv.side-solid-angle", "None to the eye: 0.057 % too bright after 30 steps.", "A digit was copied wrong, and copied on by at least six programs.", "0.4234413544 sr", "0.4234313544 sr = 2 atan(3 sqrt 11 / 11) - pi / 3",
         "Energy of an even field after many steps (lab 4, task 4)", "tests/gl/lpv_deviations_test.cpp: SideSolidAngle"},
    Room{"lpv.four-pi-kernel", "Nearly black, or growing without end with an amplifier set by eye.", "The fluxes are reprojected by 1 / (4 pi) for 1 / pi.", "Omega / (4 pi) lobe(n)", "Omega / pi lobe(n)", "Energy of one step: a quarter is left (lab 4, task 4)", "tests/gl/lpv_deviations_test.cpp: FourPiKernel"},
    Room{"lpv.fewer-steps", "Darker, most beside lit surfaces.", "N steps run N - 1, and the injected grid itself is left out of the sum.", "G1 + ... + G(N-1)", "G0 + ... + GN", "Flux in a grid of 3^3 cells, step by step", "tests/gl/lpv_deviations_test.cpp: FewerSteps"},
    Room{"lpv.block-first-step", "Some percent darker about lit surfaces.", "A light's own surface lies half a cell away and blocks it in its first step.", "step 1 blocked", "step 1 not blocked", "A light on a wall: flux after one step", "tests/gl/lpv_deviations_test.cpp: BlockFirstStep"},
    Room{"lpv.surfel-area", "Walls block too much or too little with the distance of the light.", "The area of a perspective light's texel is used for parallel light.", "4 d^2 / texels <n, l>", "A / <n, l>", "A plate of known area, tilted", "tests/gl/lpv_deviations_test.cpp: SurfelArea"},
    Room{"lpv.unwindowed", "Two lights from opposite sides give less than one.", "Two bands ring: light that travels away from a surface counts negative.", "max(0, <c, lobe(-n)>)", "band 1 of the receiver's lobe times 3/4", "Two opposite lights beside one", "tests/gl/lpv_deviations_test.cpp: Unwindowed"},
    Room{"lpv.half-grids", "A few percent too dark, more where many lights share a cell.", "Sums are kept in 16 bits: what is less than half a unit in the last of 11 places is lost.", "10,000 lights in a cell count as at most 2,048",
         "sums in 32 bits, 16 for the result alone", "Many equal lights in one cell", "tests/gl/lpv_deviations_test.cpp: HalfGrids"},
    Room{"lpv.blocking-direction", "Walls let through what meets their front and block what leaves their back.", "The blocking potential is evaluated along the light instead of against it.", "1 - B(w)", "1 - B(-w)", "A wall, lit from either side", "tests/gl/lpv_deviations_test.cpp: BlockingDirection"},
    Room{"path.distance-without-pdf", "Dense channels of a medium nearly black.", "Distances are drawn from the least extinction and never divided by their density.", "t from min sigma_t, throughput exp(-sigma_t t)", "value / density, the channel chosen by throughput",
         "A slab of known reflectance (lab 8)", "tests/physics/media_deviations_test.cpp: DistanceWithoutPdf"},
    Room{"path.boosted-interaction", "Dark liquids look milky.", "The probability to scatter is raised to a half and not divided out.", "max(albedo, 0.5)", "albedo", "A slab of albedo 0.2", "tests/physics/media_deviations_test.cpp: BoostedInteraction"},
    Room{"path.roulette-without-division", "The deeper the light, the darker: an albedo of 1 looks like 0.95.", "Survivors of Russian roulette do not count for those that ended.", "throughput", "throughput / q", "The furnace: 0.706 for 1 (lab 7, task 4)", "tests/physics/media_deviations_test.cpp: RouletteWithoutDivision"},
    Room{"path.roulette-at-surfaces", "Deep light in media takes for ever; with undivided survivors it is brighter than it would be.", "Roulette is played once a turn of the outer loop, after the medium as a whole.", "once a turn", "at collisions too",
         "Time a path; with path.roulette-without-division a half-space: 0.95 for 0.5373", "tests/physics/media_deviations_test.cpp: RouletteAtSurfaces"},
    Room{"path.unattenuated-shadow-rays", "What lies in or behind a medium is too bright.", "A shadow ray tells lit or in shadow alone; what the medium takes on the way is forgotten.", "lit or in shadow", "times exp(-sigma_t d)",
         "A lamp behind a layer of optical depth 1: 2.718 times its light (lab 8)", "tests/physics/media_deviations_test.cpp: UnattenuatedShadowRays"},
    Room{"path.fresnel-amplitudes", "Glass reflects wrongly at an angle; rightly when looked at straight.", "Amplitudes are averaged instead of their squares.", "F = (rs + rp) / 2", "F = (rs^2 + rp^2) / 2", "Reflectance over angle", "tests/physics/media_deviations_test.cpp: FresnelAmplitudesAndSchlick"},
    Room{"path.schlick", "A percent off, most near total reflection.", "Schlick's approximation is fitted from outside and used from inside too.", "F0 + (1 - F0)(1 - cos)^5", "Fresnel's equations", "A slab with a boundary", "tests/physics/media_deviations_test.cpp: FresnelAmplitudesAndSchlick"},
    Room{"path.straight-shadow-rays", "Light below water is too dark or too bright, and has no caustics.", "Shadow rays go straight through refracting boundaries.", "light asked straight through", "such a line carries no light", "A light above water of index 1.33: 0.25 for 0.3193", "tests/physics/media_deviations_test.cpp: StraightShadowRays"},
    Room{"path.linear-seeds", "The noise of one picture is that of another, moved.", "All pixels share one cycle of the generator, each begins at its own number.", "state = pixel number", "a hash of pixel, sample and event", "Correlation of two seeds' pictures", "tests/physics/media_deviations_test.cpp: LinearSeeds"},
    Room{"path.fixed-epsilon", "Thin things vanish; in tiny scenes everything does.", "Rays start a fixed 0.001 beside a surface, whatever the scene's size.", "x + 0.001 n", "units in the last place", "A slab of 1/2048 unit", "tests/physics/media_deviations_test.cpp: FixedEpsilon"},
    Room{"radiosity.published-map", "Rooms lit from the ceiling are 12 to 14 % wrong at any resolution; the furnace test sees nothing.", "Pixels of the hemicube are weighted by 1 / r^2 for 1 / r^4, and scaled so that the sum is right.", "1 / r^2, b / r^2", "1 / (pi r^4), z / (pi r^4)",
         "Form factor of a square (lab 6, tasks 1 and 2)", "tests/gl/radiosity_solution_test.cpp: TheCubeWithALitCeilingAndThePublishedMap"},
    Room{"radiosity.centroid", "Wrong where large patches meet in a corner.", "One hemicube at the middle stands for a patch of any size.", "F at the centroid", "mean over the receiver's parts", "Reciprocity A_i F_ij = A_j F_ji", "tests/gl/radiosity_solution_test.cpp: EachDeviationDoesWhatItSays"},
    Room{"radiosity.fixed-orientation", "Bands in the light of small sources.", "All hemicubes are turned alike, so that their errors are alike too.", "towards the first corner", "turned at random", "A small source seen from many patches", "tests/gl/radiosity_solution_test.cpp: EachDeviationDoesWhatItSays"},
    Room{"radiosity.no-near-field", "What touches a patch is not seen, and small sources flicker between patches.", "Pixels alone decide; what is nearer than the near plane is cut off.", "pixels alone", "closed forms and a repair of the rows", "A source of side 0.02 at distance 1", "tests/gl/radiosity_solution_test.cpp: EachDeviationDoesWhatItSays"},
};

}  // namespace

std::span<const Room> museumRooms() { return kRooms; }

}  // namespace lucerna::demo::labs
