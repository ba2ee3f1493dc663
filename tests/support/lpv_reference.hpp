// The double-precision CPU reference implementation of the light-propagation-volume pipeline (no GL): VPL injection,
// geometry volume, propagation, accumulation, lookup and the camera-following grid.
//
// It is derived from the formulas, never from the shaders, so that the two can be held against each other. Sources:
// [Kaplanyan2010] for the scheme; [Kirsch2010] for its factors (VPL intensity Phi/pi, face flux Omega * I without
// 1/(4 pi)); [LPV2015] and its public demo for the deviations from the kernel.
//
// Units: positions and cell sizes in scene units; flux in W (any unit will do: everything is linear in it); SH
// coefficients of one channel in W/sr times the basis' sr^(1/2); irradiance in W per square scene unit.
//
// SH bands 0 and 1 are kept in the order (1; x, y, z) with plus signs. The published packing (1; -y, z, -x) differs by
// order and sign only, which cancel as long as projection and evaluation share them.
#pragma once

#include "base/angles.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

namespace lucerna::reference {

// ---- spherical harmonics, bands 0 and 1 --------------------------------------------------------------------------

/// Y00 = 1 / (2 sqrt(pi)).
inline constexpr double kY00 = 0.5 * std::numbers::inv_sqrtpi;
/// Y1 = sqrt(3) / (2 sqrt(pi)), times x, y or z of the unit direction.
inline constexpr double kY1 = 0.5 * std::numbers::sqrt3 * std::numbers::inv_sqrtpi;
/// Band 0 of max(0, cos): sqrt(pi) / 2.
inline constexpr double kLobeBand0 = 0.5 / std::numbers::inv_sqrtpi;
/// Band 1 of max(0, cos): sqrt(pi / 3), times the lobe's axis.
inline constexpr double kLobeBand1 = 1.0 / (std::numbers::inv_sqrtpi * std::numbers::sqrt3);

/// A function on the sphere in SH bands 0 and 1.
struct Sh {
  double c0 = 0.0;
  glm::dvec3 c1{0.0};

  Sh& operator+=(const Sh& other) {
    c0 += other.c0;
    c1 += other.c1;
    return *this;
  }
  friend Sh operator+(Sh a, const Sh& b) { return a += b; }
  friend Sh operator-(const Sh& a, const Sh& b) { return {a.c0 - b.c0, a.c1 - b.c1}; }
  friend Sh operator*(double scale, const Sh& sh) { return {scale * sh.c0, scale * sh.c1}; }
  friend bool operator==(const Sh& a, const Sh& b) { return a.c0 == b.c0 && a.c1 == b.c1; }
};

/// The function's value in a direction; the direction is taken as it is (only deviations pass one that is not unit).
double evaluate(const Sh& sh, const glm::dvec3& direction);
/// The integral over the sphere of the product of two functions.
double dot(const Sh& a, const Sh& b);
/// max(0, <axis|w>) in two bands = 0.25 + 0.5 cos: 0.75 along the axis, 0.25 across it, -0.25 behind.
Sh lobe(const glm::dvec3& axis, double band1 = kLobeBand1);
/// The integral over the sphere, i.e. the flux of an intensity.
double flux(const Sh& sh);
/// Length of the vector of the four coefficients.
double length(const Sh& sh);

// ---- grids ---------------------------------------------------------------------------------------------------------

struct GridSpec {
  glm::ivec3 dims{0};  ///< cells per axis
  glm::dvec3 minimum{0.0};  ///< the corner with the least coordinates, scene units
  double cellSize = 1.0;  ///< scene units

  std::size_t cellCount() const;
  bool contains(const glm::ivec3& cell) const;
  std::size_t index(const glm::ivec3& cell) const;  ///< x fastest; the cell must be inside
  glm::dvec3 centre(const glm::ivec3& cell) const;
};
bool operator==(const GridSpec& a, const GridSpec& b);

/// How a coordinate becomes a cell index. Truncation is a published mistake: it folds (-1, 0) onto cell 0.
enum class IndexRule { floor, truncate };

/// The cell that holds a point, or nothing where the point is outside or not finite.
std::optional<glm::ivec3> cellOf(const GridSpec& grid, const glm::dvec3& point, IndexRule rule = IndexRule::floor);

/// One colour channel of a grid.
struct Volume {
  GridSpec grid;
  std::vector<Sh> cells;

  Volume() = default;
  explicit Volume(const GridSpec& spec) : grid(spec), cells(spec.cellCount()) {}
  Sh& at(const glm::ivec3& cell) { return cells[grid.index(cell)]; }
  const Sh& at(const glm::ivec3& cell) const { return cells[grid.index(cell)]; }
};
using VolumeRgb = std::array<Volume, 3>;

VolumeRgb makeVolumeRgb(const GridSpec& grid);
/// a += b; the grids must be the same (throws std::invalid_argument).
void add(Volume& a, const Volume& b);
/// The flux of all cells.
double totalFlux(const Volume& volume);
glm::dvec3 totalFlux(const VolumeRgb& volume);

// ---- injection -----------------------------------------------------------------------------------------------------

/// A virtual point light, and the surfel that it came from.
struct Vpl {
  glm::dvec3 position{0.0};
  glm::dvec3 normal{0.0};  ///< any length but zero; normalised on use
  glm::dvec3 flux{0.0};  ///< RGB, W; radiant intensity is flux/pi * max(0, cos)
  double area = 0.0;  ///< true surface area, for the geometry volume
  glm::dvec3 albedo{0.0};  ///< RGB, for bounces
};

struct InjectionOptions {
  double normalShift = 0.5;  ///< cells that a VPL is moved along its normal before its cell is sought
  IndexRule indexRule = IndexRule::floor;
  int lowestCell = 0;  ///< 1: the published bounds test with > for >=
};

/// Adds Phi/pi * lobe(n) to the VPL's cell. False where it was dropped: outside, normal zero or not finite, position or
/// flux not finite.
bool inject(VolumeRgb& volume, const Vpl& vpl, const InjectionOptions& options = {});
/// Injects all; the number that was not dropped.
std::size_t inject(VolumeRgb& volume, std::span<const Vpl> vpls, const InjectionOptions& options = {});

// ---- geometry volume -----------------------------------------------------------------------------------------------

/// The grid of the blocking potential: one cell more in each axis, centred on the corners of the LPV's cells.
GridSpec geometryGrid(const GridSpec& lpvGrid);
/// The geometry-volume cell of a point, floor((p - minimum of the LPV) / s + 0.5).
std::optional<glm::ivec3> geometryCellOf(const GridSpec& lpvGrid, const glm::dvec3& point,
                                         IndexRule rule = IndexRule::floor);
/// Adds A/s^2 * lobe(n) of the VPL's surfel, which is not moved. False where it was dropped (as for inject, and where
/// the area is not finite). `geometry` lies on geometryGrid(lpvGrid).
bool injectSurfel(Volume& geometry, const GridSpec& lpvGrid, const Vpl& surfel, IndexRule rule = IndexRule::floor);
std::size_t injectSurfels(Volume& geometry, const GridSpec& lpvGrid, std::span<const Vpl> surfels,
                          IndexRule rule = IndexRule::floor);
/// Merges the geometry volumes of two views of one scene into a: per cell the longer coefficient vector, so that a
/// surface seen twice counts once.
void mergeByGreatest(Volume& a, const Volume& b);

// ---- propagation ---------------------------------------------------------------------------------------------------

/// Solid angle of the far face of a unit cell seen from the neighbour's centre: 4 atan(sqrt(11)/33) sr.
double frontSolidAngle();
/// Solid angle of one of its four side faces: -pi/3 + 2 atan(3 sqrt(11)/11) sr. Front + 4 sides = 2 pi/3.
double sideSolidAngle();
/// The digit slip that many public kernels share, for sideSolidAngle().
inline constexpr double kSlippedSideSolidAngle = 0.4234413544;

/// How the directions to the side faces are made.
enum class SideDirections {
  exact,  ///< (2p + n) / |2p + n|, reprojected about n
  componentProduct,  ///< published mistake: p times (a/sqrt5, b/sqrt5, 2/sqrt5) and p times (a, b, 0) by component
};

/// The kernel; the defaults are the corrected one, every other value is a deviation.
struct KernelOptions {
  double frontSolidAngle = reference::frontSolidAngle();
  double sideSolidAngle = reference::sideSolidAngle();
  SideDirections sideDirections = SideDirections::exact;
  double lobeBand1 = kLobeBand1;  ///< of the reprojected lobe
  double gain = 1.0;  ///< factor on the reprojected flux
  bool frontFaceOnly = false;  ///< leave out the four side faces
  bool clampIntensity = true;  ///< max(0, I); off for the conservation anchors only
  bool clampTransmittance = true;  ///< clamp B to [0, 1]
  bool twoSidedBlocking = false;  ///< block by max(B(w), B(-w))
  bool blockAlongTravel = false;  ///< published mistake: the potential is evaluated in the direction of travel
  bool blockFirstStep = false;  ///< off: else a VPL is blocked by its own surface
};
KernelOptions slippedSideKernel();  ///< side constant 0.4234413544
KernelOptions swappedConstantsKernel();  ///< front and side solid angle swapped
KernelOptions componentProductKernel();  ///< degenerate side directions
KernelOptions flatLobeKernel();  ///< band-1 coefficient sqrt(pi)/3 for sqrt(pi/3)
KernelOptions frontFaceKernel();  ///< front face only
/// Omega/(4 pi) with a lobe that is not divided by pi, times a "flux amplifier": gain amplifier/4.
KernelOptions fourPiKernel(double amplifier = 1.0);

/// 1 - B of light travelling along `direction`. A surfel blocks what meets its front, i.e. light with <n|w> < 0, so the
/// potential is evaluated towards where the light comes from, -w.
double transmittance(const Sh& potential, const glm::dvec3& direction, const KernelOptions& options = {});
/// The blocking potential at the centre of the face through which light that travels along the signed unit axis `axis`
/// enters `destination`: the mean of the four geometry-volume cells at that face's corners.
Sh potentialAtFace(const Volume& geometry, const glm::ivec3& destination, const glm::ivec3& axis);

/// What the exact kernel sends through the face of a cell that looks along the unit `direction`, without blocking: to
/// the far face of the next cell and its four sides. For directions between the axes the cell is turned along.
/// `clamped`: a face that looks at negative intensity gets nothing.
double fluxThroughFace(const Sh& intensity, const glm::dvec3& direction, bool clamped);

/// One step, as a gather over 6 neighbours and 5 faces, with zero beyond the border. `geometry` may be null.
Volume propagateStep(const Volume& source, const KernelOptions& options = {}, const Volume* geometry = nullptr);

struct Propagated {
  Volume front;  ///< G_k, the last wavefront
  Volume accumulated;  ///< G_0 + G_1 + ... + G_k
};
/// k = iterations steps; the first one is not blocked unless the options ask for it.
Propagated propagate(const Volume& injected, int iterations, const KernelOptions& options = {},
                     const Volume* geometry = nullptr);
struct PropagatedRgb {
  VolumeRgb front;
  VolumeRgb accumulated;
};
PropagatedRgb propagate(const VolumeRgb& injected, int iterations, const KernelOptions& options = {},
                        const Volume* geometry = nullptr);

// ---- bounces -------------------------------------------------------------------------------------------------------

/// Albedo times A/s^2 of all surfels of a geometry-volume cell, RGB in band 0 of a volume on the same grid as the
/// geometry.
VolumeRgb injectReflectance(const GridSpec& lpvGrid, std::span<const Vpl> surfels);
/// What a cosine lobe along an axis gains in its first step, by the clamp of negative intensities: 1.138208.
double clampGain();
/// What surfaces throw back of `light`, the sum of wavefronts without its source: at each of a cell's six faces the
/// flux to the five faces beyond that the potential holds back, times the mean albedo over clampGain(), back into the
/// cell as a lobe about the potential's axis.
VolumeRgb reflect(const VolumeRgb& light, const Volume& geometry, const VolumeRgb& reflectance);
struct Bounced {
  VolumeRgb source;  ///< injected light and what came back of it, `bounces` - 1 times
  VolumeRgb light;  ///< that, propagated
};
Bounced propagateBounces(const VolumeRgb& injected, int iterations, int bounces, const Volume& geometry,
                         const VolumeRgb& reflectance);

// ---- lookup --------------------------------------------------------------------------------------------------------

enum class Lookup {
  cosine,  ///< E = 4/(pi s^2) * <c | lobe(-n)>
  direct,  ///< E = 4/s^2 * I(-n)
  windowed,  ///< cosine with the receiver's band 1 times 3/4: no sum of cosine lobes gives negative light
  flux,  ///< E = what the kernel sends through a face across the normal, / s^2; offset 0 goes with it
};
struct LookupOptions {
  Lookup lookup = Lookup::windowed;
  double normalOffset = 0.5;  ///< cells along the normal from the surface to the point that is sampled
};

/// Trilinear interpolation between cell centres, zero beyond them (GL_LINEAR with GL_CLAMP_TO_BORDER, border 0).
Sh sampleTrilinear(const Volume& volume, const glm::dvec3& point);
/// Irradiance from the coefficients at a point with unit normal; never negative.
double irradiance(const Sh& sh, const glm::dvec3& normal, double cellSize, Lookup lookup = Lookup::windowed);
/// Irradiance at a surface point with unit normal.
double irradiance(const Volume& volume, const glm::dvec3& point, const glm::dvec3& normal,
                  const LookupOptions& options = {});
glm::dvec3 irradiance(const VolumeRgb& volume, const glm::dvec3& point, const glm::dvec3& normal,
                      const LookupOptions& options = {});

/// Published mistake: the cascades' irradiances added instead of blended, up to as many times too bright as there are.
double irradianceSumOfCascades(std::span<const Volume> cascades, const glm::dvec3& point, const glm::dvec3& normal,
                               const LookupOptions& options = {});

// ---- cascades joined into one picture
// ---------------------------------------------------------------------------------

/// One cascade's accumulated light in two parts.
struct CascadeParts {
  VolumeRgb first;  ///< M = G_0 + ... + G_h: the next finer cascade carries this light by itself
  VolumeRgb later;  ///< F = G_h+1 + ... + G_N: too far-travelled for the finer one, handed over to it
};
/// propagate() with the sum split after `handOver` steps.
CascadeParts propagateParts(const VolumeRgb& injected, int iterations, int handOver, const KernelOptions& options = {},
                            const Volume* geometry = nullptr);

struct JoinOptions {
  double largestBalance = 4.0;  ///< b and 1/b at most
  double dark = 0.0;  ///< c/s^2 that both sides of the balance are lifted by, so that no light is balanced against none
};
/// Joins cascades, finest first. All terms are values of c/s^2, up is trilinear with zeros beyond the border:
///   C_k = b_k (M_k + F_k) + up(R_k+1),  R_k = b_k F_k + up(R_k+1);  the coarsest: C = M + F, R = F.
///   b_k = upHeld((max(0, up(C_k+1 - R_k+1)) + dark) / (down(M_k + F_k) + dark)), bounded, of band 0 summed over the
///   three channels: the
/// finer grid gets the brightness of what it replaces. down is the mean of 2x2x2 cells, upHeld is trilinear, held
/// beyond the border. The results C are in plain units again.
std::vector<VolumeRgb> joinCascades(std::span<const CascadeParts> cascades, const JoinOptions& options = {});

struct CascadeBlend {
  std::vector<glm::dvec3> centres;  ///< of the cascades before snapping, finest first
  double band = 0.25;  ///< fraction of blendHalf over which a cascade fades
};
/// How much each cascade counts at a point, finest first; the coarsest takes what is left, so that the sum is 1. With
/// blendHalf = (cells/2 - 2.5 - lookupOffset) * s: weight_k = left * clamp((blendHalf - max|p - centre|) / (band *
/// blendHalf), 0, 1). A cascade of so few cells that its blendHalf is not positive counts nothing.
std::vector<double> blendWeights(std::span<const Volume> cascades, const CascadeBlend& blend, const glm::dvec3& point,
                                 double lookupOffset);
/// The weighted sum of the cascades' irradiances.
double blendedIrradiance(std::span<const Volume> cascades, const CascadeBlend& blend, const glm::dvec3& point,
                         const glm::dvec3& normal, const LookupOptions& options = {});

// ---- the grid that follows the camera ------------------------------------------------------------------------------

/// The published snapping rounds by int(x + 0.5), wrong for negatives, and then truncates to whole scene units.
enum class SnapRule { floor, truncate };

struct SnappedGrid {
  glm::i64vec3 corner{0};  ///< the minimum in cells from the world's origin
  GridSpec grid;  ///< minimum = corner * cellSize
};
/// Centre = camera + direction * 0.8 * 0.5 * extent; minimum = floor((centre - extent/2) / s) * s per axis, in double.
SnappedGrid cameraGrid(const glm::dvec3& camera, const glm::dvec3& viewDirection, const glm::ivec3& dims,
                       double cellSize, SnapRule rule = SnapRule::floor);

// ---- VPLs of a lit plate -------------------------------------------------------------------------------------------

/// A flat rectangle, lit from either side.
struct Plate {
  glm::dvec3 centre{0.0};
  glm::dvec3 edgeU{1.0, 0.0, 0.0};  ///< the full edges, perpendicular to each other
  glm::dvec3 edgeV{0.0, 1.0, 0.0};
  glm::dvec3 albedo{1.0};
};
/// A reflective shadow map of a directional light, without a raster: texel centres are cast as rays.
struct OrthographicRsm {
  glm::dvec3 centre{0.0};
  glm::dvec3 right{1.0, 0.0, 0.0};  ///< unit
  glm::dvec3 up{0.0, 1.0, 0.0};  ///< unit; light travels along cross(up, right)
  double width = 1.0;  ///< scene units
  double height = 1.0;
  glm::ivec2 texels{1};
  glm::dvec3 irradiance{1.0};  ///< on a surface perpendicular to the light

  glm::dvec3 direction() const { return glm::cross(up, right); }
  double texelArea() const;  ///< perpendicular to the light
};
/// The map whose window is the projection of a plate that is tilted about its edge U, light travelling along -z.
OrthographicRsm fittedRsm(const Plate& plate, const glm::ivec2& texels, const glm::dvec3& irradiance);
/// A plate in the plane z = 0, turned by `tilt` radians about its x edge.
Plate tiltedPlate(const glm::dvec3& centre, double sizeU, double sizeV, double tilt, const glm::dvec3& albedo);
/// One VPL per texel that sees the plate: flux = E * albedo * A_texel without N.L (the tilt is in the density of the
/// texels already), area = A_texel / cos.
std::vector<Vpl> plateVpls(const Plate& plate, const OrthographicRsm& rsm);

}  // namespace lucerna::reference
