// The double-precision CPU reference implementation of the light-propagation-volume pipeline; see the header for
// sources and units.
#include "support/lpv_reference.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace lucerna::reference {

namespace {

constexpr int kAxes = 6;
/// The six signed axes, the directions in which light travels to a neighbour and the outward normals of a cell's faces.
const std::array<glm::ivec3, kAxes> kAxis = {glm::ivec3(1, 0, 0),  glm::ivec3(-1, 0, 0), glm::ivec3(0, 1, 0),
                                             glm::ivec3(0, -1, 0), glm::ivec3(0, 0, 1),  glm::ivec3(0, 0, -1)};

bool isFinite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

/// The unit vector, or nothing where there is none.
std::optional<glm::dvec3> unit(const glm::dvec3& v) {
  if (!isFinite(v)) return std::nullopt;
  const double norm = std::hypot(v.x, v.y, v.z);
  if (!(norm > 0.0) || !std::isfinite(norm)) return std::nullopt;
  return v / norm;
}

/// Cell of a point given in cells from the grid's minimum. The range is tested in double: no integer can overflow.
std::optional<glm::ivec3> cellAt(const glm::ivec3& dims, const glm::dvec3& inCells, IndexRule rule) {
  glm::ivec3 cell(0);
  for (int axis = 0; axis < 3; ++axis) {
    const double whole = rule == IndexRule::floor ? std::floor(inCells[axis]) : std::trunc(inCells[axis]);
    if (!(whole >= 0.0 && whole < static_cast<double>(dims[axis]))) return std::nullopt;
    cell[axis] = static_cast<int>(whole);
  }
  return cell;
}

void requireSameGrid(const Volume& a, const Volume& b) {
  if (!(a.grid == b.grid))
    throw std::invalid_argument("lpv reference implementation: the two volumes lie on different grids");
}

/// What one of the five faces of the destination receives from the source.
struct FaceTerm {
  glm::dvec3 towardsFace;  ///< w_f, from the source's centre to the face's
  double solidAngle = 0.0;  ///< Omega_f, sr
  Sh reprojected;  ///< gain/pi * lobe(n_f): what a unit flux through the face adds to the destination
};
struct AxisTerms {
  glm::ivec3 axis{0};
  std::vector<FaceTerm> faces;
};

/// The degenerate side directions of a public kernel: the axis is multiplied by component with a vector that is
/// right for travel along +z only, instead of rotating it.
void addComponentProductSides(AxisTerms& terms, const KernelOptions& options, double perFlux) {
  const std::array<glm::dvec2, 4> sides = {glm::dvec2(1, 0), glm::dvec2(0, 1), glm::dvec2(-1, 0), glm::dvec2(0, -1)};
  const glm::dvec3 axis(terms.axis);
  for (const glm::dvec2& side : sides) {
    const glm::dvec3 towards = axis * (glm::dvec3(side, 2.0) / std::sqrt(5.0));
    const glm::dvec3 reprojection = axis * glm::dvec3(side, 0.0);
    terms.faces.push_back({towards, options.sideSolidAngle, perFlux * lobe(reprojection, options.lobeBand1)});
  }
}

/// The 30 terms of the kernel, [Kaplanyan2010 section 4.2] with the factors of [Kirsch2010].
std::array<AxisTerms, kAxes> kernelTerms(const KernelOptions& options) {
  const double perFlux = options.gain / kPi;
  std::array<AxisTerms, kAxes> kernel;
  for (std::size_t i = 0; i < kernel.size(); ++i) {
    AxisTerms& terms = kernel[i];
    terms.axis = kAxis[i];
    const glm::dvec3 p(terms.axis);
    terms.faces.push_back({p, options.frontSolidAngle, perFlux * lobe(p, options.lobeBand1)});
    if (options.frontFaceOnly) continue;
    if (options.sideDirections == SideDirections::componentProduct) {
      addComponentProductSides(terms, options, perFlux);
      continue;
    }
    for (const glm::ivec3& normal : kAxis) {
      if (normal == terms.axis || normal == -terms.axis) continue;
      const glm::dvec3 n(normal);
      terms.faces.push_back(
          {glm::normalize(2.0 * p + n), options.sideSolidAngle, perFlux * lobe(n, options.lobeBand1)});
    }
  }
  return kernel;
}

}  // namespace

// ---- spherical harmonics -------------------------------------------------------------------------------------------

double evaluate(const Sh& sh, const glm::dvec3& direction) { return sh.c0 * kY00 + kY1 * glm::dot(sh.c1, direction); }

double dot(const Sh& a, const Sh& b) { return a.c0 * b.c0 + glm::dot(a.c1, b.c1); }

Sh lobe(const glm::dvec3& axis, double band1) { return {kLobeBand0, band1 * axis}; }

double flux(const Sh& sh) { return sh.c0 / kY00; }

double length(const Sh& sh) { return std::sqrt(dot(sh, sh)); }

// ---- grids ---------------------------------------------------------------------------------------------------------

std::size_t GridSpec::cellCount() const {
  return static_cast<std::size_t>(dims.x) * static_cast<std::size_t>(dims.y) * static_cast<std::size_t>(dims.z);
}

bool GridSpec::contains(const glm::ivec3& cell) const {
  return cell.x >= 0 && cell.y >= 0 && cell.z >= 0 && cell.x < dims.x && cell.y < dims.y && cell.z < dims.z;
}

std::size_t GridSpec::index(const glm::ivec3& cell) const {
  const auto x = static_cast<std::size_t>(cell.x);
  const auto y = static_cast<std::size_t>(cell.y);
  const auto z = static_cast<std::size_t>(cell.z);
  return (z * static_cast<std::size_t>(dims.y) + y) * static_cast<std::size_t>(dims.x) + x;
}

glm::dvec3 GridSpec::centre(const glm::ivec3& cell) const { return minimum + cellSize * (glm::dvec3(cell) + 0.5); }

bool operator==(const GridSpec& a, const GridSpec& b) {
  return a.dims == b.dims && a.minimum == b.minimum && a.cellSize == b.cellSize;
}

std::optional<glm::ivec3> cellOf(const GridSpec& grid, const glm::dvec3& point, IndexRule rule) {
  return cellAt(grid.dims, (point - grid.minimum) / grid.cellSize, rule);
}

VolumeRgb makeVolumeRgb(const GridSpec& grid) { return {Volume(grid), Volume(grid), Volume(grid)}; }

void add(Volume& a, const Volume& b) {
  requireSameGrid(a, b);
  for (std::size_t i = 0; i < a.cells.size(); ++i) a.cells[i] += b.cells[i];
}

double totalFlux(const Volume& volume) {
  double sum = 0.0;
  for (const Sh& cell : volume.cells) sum += flux(cell);
  return sum;
}

glm::dvec3 totalFlux(const VolumeRgb& volume) {
  return {totalFlux(volume[0]), totalFlux(volume[1]), totalFlux(volume[2])};
}

// ---- injection -----------------------------------------------------------------------------------------------------

bool inject(VolumeRgb& volume, const Vpl& vpl, const InjectionOptions& options) {
  const std::optional<glm::dvec3> normal = unit(vpl.normal);
  if (!normal || !isFinite(vpl.position) || !isFinite(vpl.flux)) return false;
  const GridSpec& grid = volume[0].grid;
  const glm::dvec3 moved = vpl.position + options.normalShift * grid.cellSize * *normal;
  const std::optional<glm::ivec3> cell = cellOf(grid, moved, options.indexRule);
  if (!cell || glm::any(glm::lessThan(*cell, glm::ivec3(options.lowestCell)))) return false;
  for (int channel = 0; channel < 3; ++channel) {
    volume[static_cast<std::size_t>(channel)].at(*cell) += (vpl.flux[channel] / kPi) * lobe(*normal);
  }
  return true;
}

std::size_t inject(VolumeRgb& volume, std::span<const Vpl> vpls, const InjectionOptions& options) {
  std::size_t kept = 0;
  for (const Vpl& vpl : vpls) kept += inject(volume, vpl, options) ? 1U : 0U;
  return kept;
}

// ---- geometry volume -----------------------------------------------------------------------------------------------

GridSpec geometryGrid(const GridSpec& lpvGrid) {
  return {lpvGrid.dims + 1, lpvGrid.minimum - 0.5 * lpvGrid.cellSize, lpvGrid.cellSize};
}

std::optional<glm::ivec3> geometryCellOf(const GridSpec& lpvGrid, const glm::dvec3& point, IndexRule rule) {
  return cellAt(lpvGrid.dims + 1, (point - lpvGrid.minimum) / lpvGrid.cellSize + 0.5, rule);
}

bool injectSurfel(Volume& geometry, const GridSpec& lpvGrid, const Vpl& surfel, IndexRule rule) {
  const std::optional<glm::dvec3> normal = unit(surfel.normal);
  if (!normal || !isFinite(surfel.position) || !std::isfinite(surfel.area)) return false;
  const std::optional<glm::ivec3> cell = geometryCellOf(lpvGrid, surfel.position, rule);
  if (!cell) return false;
  geometry.at(*cell) += (surfel.area / (lpvGrid.cellSize * lpvGrid.cellSize)) * lobe(*normal);
  return true;
}

std::size_t injectSurfels(Volume& geometry, const GridSpec& lpvGrid, std::span<const Vpl> surfels, IndexRule rule) {
  std::size_t kept = 0;
  for (const Vpl& surfel : surfels) kept += injectSurfel(geometry, lpvGrid, surfel, rule) ? 1U : 0U;
  return kept;
}

void mergeByGreatest(Volume& a, const Volume& b) {
  requireSameGrid(a, b);
  for (std::size_t i = 0; i < a.cells.size(); ++i) {
    if (length(b.cells[i]) > length(a.cells[i])) a.cells[i] = b.cells[i];
  }
}

// ---- propagation ---------------------------------------------------------------------------------------------------

double frontSolidAngle() { return 4.0 * std::atan(std::sqrt(11.0) / 33.0); }

double sideSolidAngle() { return -kPi / 3.0 + 2.0 * std::atan(3.0 * std::sqrt(11.0) / 11.0); }

KernelOptions slippedSideKernel() {
  KernelOptions options;
  options.sideSolidAngle = kSlippedSideSolidAngle;
  return options;
}

KernelOptions swappedConstantsKernel() {
  KernelOptions options;
  std::swap(options.frontSolidAngle, options.sideSolidAngle);
  return options;
}

KernelOptions componentProductKernel() {
  KernelOptions options;
  options.sideDirections = SideDirections::componentProduct;
  return options;
}

KernelOptions flatLobeKernel() {
  KernelOptions options;
  options.lobeBand1 = std::sqrt(kPi) / 3.0;
  return options;
}

KernelOptions fourPiKernel(double amplifier) {
  KernelOptions options;
  options.gain = 0.25 * amplifier;  // Omega/(4 pi) * lobe for Omega * lobe/pi
  return options;
}

KernelOptions frontFaceKernel() {
  KernelOptions options;
  options.frontFaceOnly = true;
  return options;
}

double transmittance(const Sh& potential, const glm::dvec3& direction, const KernelOptions& options) {
  double blocked = evaluate(potential, options.blockAlongTravel ? direction : -direction);
  if (options.twoSidedBlocking) blocked = std::max(blocked, evaluate(potential, direction));
  if (options.clampTransmittance) blocked = std::clamp(blocked, 0.0, 1.0);
  return 1.0 - blocked;
}

Sh potentialAtFace(const Volume& geometry, const glm::ivec3& destination, const glm::ivec3& axis) {
  // Corner j of the LPV is the centre of geometry cell j. The face lies on the destination's low side where light
  // travels up the axis, else on its high side.
  glm::ivec3 corner = destination;
  std::array<glm::ivec3, 2> across{};  // the two axes in the face's plane
  std::size_t found = 0;
  for (int i = 0; i < 3; ++i) {
    if (axis[i] != 0) {
      if (axis[i] < 0) ++corner[i];
    } else {
      glm::ivec3 step(0);
      step[i] = 1;
      across[found++] = step;
    }
  }
  return 0.25 * (geometry.at(corner) + geometry.at(corner + across[0]) + geometry.at(corner + across[1]) +
                 geometry.at(corner + across[0] + across[1]));
}

double fluxThroughFace(const Sh& intensity, const glm::dvec3& direction, bool clamped) {
  const glm::dvec3 helper = std::abs(direction.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  const glm::dvec3 across = glm::normalize(glm::cross(direction, helper)), other = glm::cross(direction, across);
  const auto towards = [&](const glm::dvec3& w) {
    return clamped ? std::max(0.0, evaluate(intensity, w)) : evaluate(intensity, w);
  };
  double sum = frontSolidAngle() * towards(direction);
  for (const glm::dvec3& side : {across, -across, other, -other})
    sum += sideSolidAngle() * towards(glm::normalize(2.0 * direction + side));
  return sum;
}

Volume propagateStep(const Volume& source, const KernelOptions& options, const Volume* geometry) {
  const GridSpec& grid = source.grid;
  if (geometry != nullptr && !(geometry->grid == geometryGrid(grid))) {
    throw std::invalid_argument(
        "lpv reference implementation: the geometry volume does not lie on the corners of the propagated grid");
  }
  const std::array<AxisTerms, kAxes> kernel = kernelTerms(options);
  Volume destination(grid);
  for (int z = 0; z < grid.dims.z; ++z) {
    for (int y = 0; y < grid.dims.y; ++y) {
      for (int x = 0; x < grid.dims.x; ++x) {
        const glm::ivec3 cell(x, y, z);
        Sh gathered;
        for (const AxisTerms& terms : kernel) {
          const glm::ivec3 from = cell - terms.axis;
          if (!grid.contains(from)) continue;
          const Sh& incoming = source.at(from);
          if (incoming == Sh{}) continue;  // most cells, in the first steps
          Sh potential = geometry != nullptr ? potentialAtFace(*geometry, cell, terms.axis) : Sh{};
          for (const FaceTerm& face : terms.faces) {
            double intensity = evaluate(incoming, face.towardsFace);
            if (options.clampIntensity) intensity = std::max(0.0, intensity);
            double faceFlux = face.solidAngle * intensity;
            if (geometry != nullptr) faceFlux *= transmittance(potential, face.towardsFace, options);
            gathered += faceFlux * face.reprojected;
          }
        }
        destination.at(cell) = gathered;
      }
    }
  }
  return destination;
}

Propagated propagate(const Volume& injected, int iterations, const KernelOptions& options, const Volume* geometry) {
  Propagated result{injected, injected};
  for (int step = 0; step < iterations; ++step) {
    const bool blocks = step > 0 || options.blockFirstStep;
    result.front = propagateStep(result.front, options, blocks ? geometry : nullptr);
    add(result.accumulated, result.front);
  }
  return result;
}

PropagatedRgb propagate(const VolumeRgb& injected, int iterations, const KernelOptions& options,
                        const Volume* geometry) {
  PropagatedRgb result;
  for (std::size_t channel = 0; channel < injected.size(); ++channel) {
    Propagated one = propagate(injected[channel], iterations, options, geometry);
    result.front[channel] = std::move(one.front);
    result.accumulated[channel] = std::move(one.accumulated);
  }
  return result;
}

// ---- bounces -------------------------------------------------------------------------------------------------------

namespace {
/// The flux that leaves a cell along the signed axis towards the five faces of the next cell, each with a weight of its
/// direction.
template <class Weight>
double fluxTowards(const Sh& light, const glm::ivec3& axis, const Weight& weight) {
  const glm::dvec3 p(axis);
  double sum = frontSolidAngle() * std::max(evaluate(light, p), 0.0) * weight(p);
  for (int i = 0; i < 3; ++i) {
    if (axis[i] != 0) continue;
    for (const double way : {1.0, -1.0}) {
      glm::dvec3 n(0.0);
      n[i] = way;
      const glm::dvec3 towards = glm::normalize(2.0 * p + n);
      sum += sideSolidAngle() * std::max(evaluate(light, towards), 0.0) * weight(towards);
    }
  }
  return sum;
}

std::array<glm::ivec3, 6> signedAxes() {
  return {{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}};
}
}  // namespace

VolumeRgb injectReflectance(const GridSpec& lpvGrid, std::span<const Vpl> surfels) {
  VolumeRgb result = makeVolumeRgb(geometryGrid(lpvGrid));
  for (const Vpl& surfel : surfels) {
    if (!unit(surfel.normal) || !isFinite(surfel.position) || !std::isfinite(surfel.area)) continue;
    const std::optional<glm::ivec3> cell = geometryCellOf(lpvGrid, surfel.position);
    if (!cell) continue;
    for (int channel = 0; channel < 3; ++channel)
      result[static_cast<std::size_t>(channel)].at(*cell).c0 +=
          surfel.albedo[channel] * surfel.area / (lpvGrid.cellSize * lpvGrid.cellSize);
  }
  return result;
}

double clampGain() {
  double gain = 0.0;
  for (const glm::ivec3& axis : signedAxes())
    gain += fluxTowards((1.0 / kPi) * lobe({0, 0, 1}), axis, [](const glm::dvec3&) { return 1.0; });
  return gain;
}

VolumeRgb reflect(const VolumeRgb& light, const Volume& geometry, const VolumeRgb& reflectance) {
  const GridSpec& grid = light[0].grid;
  VolumeRgb result = makeVolumeRgb(grid);
  const double gain = clampGain();
  for (int z = 0; z < grid.dims.z; ++z)
    for (int y = 0; y < grid.dims.y; ++y)
      for (int x = 0; x < grid.dims.x; ++x)
        for (const glm::ivec3& axis : signedAxes()) {
          const glm::ivec3 cell(x, y, z);
          const Sh potential = potentialAtFace(geometry, cell + axis, axis);
          if (potential.c0 <= 0.0) continue;
          const double directed = glm::length(potential.c1);
          const glm::dvec3 normal = directed > 1e-3 * potential.c0 ? potential.c1 / directed : -glm::dvec3(axis);
          for (std::size_t channel = 0; channel < 3; ++channel) {
            const double held = fluxTowards(light[channel].at(cell), axis,
                                            [&](const glm::dvec3& w) { return 1.0 - transmittance(potential, w); });
            const double albedo =
                potentialAtFace(reflectance[channel], cell + axis, axis).c0 * kLobeBand0 / potential.c0;
            result[channel].at(cell) += (albedo * held / gain / kPi) * lobe(normal);
          }
        }
  return result;
}

Bounced propagateBounces(const VolumeRgb& injected, int iterations, int bounces, const Volume& geometry,
                         const VolumeRgb& reflectance) {
  Bounced result{injected, propagate(injected, iterations, {}, &geometry).accumulated};
  for (int bounce = 1; bounce < bounces; ++bounce) {
    VolumeRgb travelled = result.light;
    for (std::size_t channel = 0; channel < 3; ++channel)
      for (std::size_t i = 0; i < travelled[channel].cells.size(); ++i)
        travelled[channel].cells[i] = travelled[channel].cells[i] - result.source[channel].cells[i];
    result.source = reflect(travelled, geometry, reflectance);
    for (std::size_t channel = 0; channel < 3; ++channel) add(result.source[channel], injected[channel]);
    result.light = propagate(result.source, iterations, {}, &geometry).accumulated;
  }
  return result;
}

// ---- lookup --------------------------------------------------------------------------------------------------------

Sh sampleTrilinear(const Volume& volume, const glm::dvec3& point) {
  const GridSpec& grid = volume.grid;
  const glm::dvec3 inCells = (point - grid.minimum) / grid.cellSize - 0.5;  // 0 at the centre of cell 0
  glm::ivec3 low(0);
  for (int axis = 0; axis < 3; ++axis) {
    if (!(inCells[axis] > -1.0 && inCells[axis] < static_cast<double>(grid.dims[axis]))) return {};
    low[axis] = static_cast<int>(std::floor(inCells[axis]));
  }
  const glm::dvec3 fraction = inCells - glm::dvec3(low);
  Sh sum;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 step(corner & 1, (corner >> 1) & 1, (corner >> 2) & 1);
    if (!grid.contains(low + step)) continue;
    double weight = 1.0;
    for (int axis = 0; axis < 3; ++axis) weight *= step[axis] == 1 ? fraction[axis] : 1.0 - fraction[axis];
    sum += weight * volume.at(low + step);
  }
  return sum;
}

double irradiance(const Sh& sh, const glm::dvec3& normal, double cellSize, Lookup lookup) {
  if (lookup == Lookup::flux) return std::max(0.0, fluxThroughFace(sh, -normal, false)) / (cellSize * cellSize);
  // [Kaplanyan2010]: the light is taken to sit half a cell away, E = I / (s/2)^2. The cosine lookup takes the mean of
  // I under the receiver's cosine, (1/pi) * integral of I * max(0, <-n|w>).
  // Windowed: two cosine lobes give pi/4 + window * pi/3 cos, negative behind for a window of 1, zero at 3/4.
  const double window = lookup == Lookup::windowed ? 0.75 : 1.0;
  const double intensity =
      lookup == Lookup::direct ? evaluate(sh, -normal) : dot(sh, lobe(-normal, window * kLobeBand1)) / kPi;
  return std::max(0.0, 4.0 / (cellSize * cellSize) * intensity);
}

double irradiance(const Volume& volume, const glm::dvec3& point, const glm::dvec3& normal,
                  const LookupOptions& options) {
  const double cellSize = volume.grid.cellSize;
  const Sh sh = sampleTrilinear(volume, point + options.normalOffset * cellSize * normal);
  return irradiance(sh, normal, cellSize, options.lookup);
}

glm::dvec3 irradiance(const VolumeRgb& volume, const glm::dvec3& point, const glm::dvec3& normal,
                      const LookupOptions& options) {
  return {irradiance(volume[0], point, normal, options), irradiance(volume[1], point, normal, options),
          irradiance(volume[2], point, normal, options)};
}

double irradianceSumOfCascades(std::span<const Volume> cascades, const glm::dvec3& point, const glm::dvec3& normal,
                               const LookupOptions& options) {
  double sum = 0.0;
  for (const Volume& cascade : cascades) sum += irradiance(cascade, point, normal, options);
  return sum;
}

// ---- cascades joined into one picture
// ---------------------------------------------------------------------------------

CascadeParts propagateParts(const VolumeRgb& injected, int iterations, int handOver, const KernelOptions& options,
                            const Volume* geometry) {
  CascadeParts parts{injected, makeVolumeRgb(injected[0].grid)};
  for (std::size_t channel = 0; channel < injected.size(); ++channel) {
    Volume front = injected[channel];
    for (int step = 0; step < iterations; ++step) {
      const bool blocks = step > 0 || options.blockFirstStep;
      front = propagateStep(front, options, blocks ? geometry : nullptr);
      add((step < handOver ? parts.first : parts.later)[channel], front);
    }
  }
  return parts;
}

std::vector<VolumeRgb> joinCascades(std::span<const CascadeParts> cascades, const JoinOptions& options) {
  // By c/s^2: every volume is divided by its s^2 first, the results are multiplied by it at the end.
  const auto scaled = [](VolumeRgb volume, double exponent) {
    for (Volume& channel : volume) {
      const double factor = std::pow(channel.grid.cellSize, exponent);
      for (Sh& cell : channel.cells) cell = factor * cell;
    }
    return volume;
  };
  std::vector<VolumeRgb> joined(cascades.size());
  VolumeRgb handedOver;  // R of the cascade before
  for (std::size_t k = cascades.size(); k-- > 0;) {
    const VolumeRgb first = scaled(cascades[k].first, -2.0), later = scaled(cascades[k].later, -2.0);
    const GridSpec& grid = first[0].grid;
    VolumeRgb light = makeVolumeRgb(grid), passedOn = makeVolumeRgb(grid);
    // b of 2x2x2 cells in band 0, from the mean of this cascade's M + F and the coarser one's M at their centre.
    Volume balances(GridSpec{(grid.dims + 1) / 2, grid.minimum, 2.0 * grid.cellSize});
    if (k + 1 < cascades.size()) {
      for (int z = 0; z < grid.dims.z; ++z)
        for (int y = 0; y < grid.dims.y; ++y)
          for (int x = 0; x < grid.dims.x; ++x)
            for (std::size_t channel = 0; channel < 3; ++channel)
              balances.at(glm::ivec3(x, y, z) / 2).c0 +=
                  (first[channel].at({x, y, z}).c0 + later[channel].at({x, y, z}).c0) / 8.0;
      for (int z = 0; z < balances.grid.dims.z; ++z)
        for (int y = 0; y < balances.grid.dims.y; ++y)
          for (int x = 0; x < balances.grid.dims.x; ++x) {
            const glm::ivec3 block(x, y, z);
            double replaced = 0.0;
            for (std::size_t channel = 0; channel < 3; ++channel)
              replaced += sampleTrilinear(joined[k + 1][channel], balances.grid.centre(block)).c0 -
                          sampleTrilinear(handedOver[channel], balances.grid.centre(block)).c0;
            double& b = balances.at(block).c0;
            b = std::clamp((std::max(0.0, replaced) + options.dark) / (b + options.dark), 1.0 / options.largestBalance,
                           options.largestBalance);
            if (std::isnan(b)) b = 1.0;  // no light, nothing to balance
          }
    }
    for (int z = 0; z < grid.dims.z; ++z) {
      for (int y = 0; y < grid.dims.y; ++y) {
        for (int x = 0; x < grid.dims.x; ++x) {
          const glm::ivec3 cell(x, y, z);
          const glm::dvec3 point = grid.centre(cell);
          double balance = 1.0;
          std::array<Sh, 3> fromCoarser;
          if (k + 1 < cascades.size()) {
            for (std::size_t channel = 0; channel < 3; ++channel)
              fromCoarser[channel] = sampleTrilinear(handedOver[channel], point);
            // Held at the edge: beyond the outermost centres their values go on.
            const glm::dvec3 lowest = balances.grid.centre({0, 0, 0}),
                             highest = balances.grid.centre(balances.grid.dims - 1);
            balance = sampleTrilinear(balances, glm::clamp(point, lowest, highest)).c0;
          }
          for (std::size_t channel = 0; channel < 3; ++channel) {
            passedOn[channel].at(cell) = balance * later[channel].at(cell) + fromCoarser[channel];
            light[channel].at(cell) = balance * first[channel].at(cell) + passedOn[channel].at(cell);
          }
        }
      }
    }
    joined[k] = std::move(light);
    handedOver = std::move(passedOn);
  }
  for (VolumeRgb& cascade : joined) cascade = scaled(std::move(cascade), 2.0);
  return joined;
}

std::vector<double> blendWeights(std::span<const Volume> cascades, const CascadeBlend& blend, const glm::dvec3& point,
                                 double lookupOffset) {
  if (blend.centres.size() != cascades.size())
    throw std::invalid_argument("lpv reference implementation: one blend centre a cascade is needed");
  std::vector<double> weights;
  double left = 1.0;
  for (std::size_t k = 0; k + 1 < cascades.size(); ++k) {
    const GridSpec& grid = cascades[k].grid;
    const double half = (0.5 * grid.dims.x - 2.5 - lookupOffset) * grid.cellSize;
    const glm::dvec3 away = glm::abs(point - blend.centres[k]);
    const double distance = std::max({away.x, away.y, away.z});
    const double weight = half > 0.0 ? left * std::clamp((half - distance) / (blend.band * half), 0.0, 1.0) : 0.0;
    weights.push_back(weight);
    left -= weight;
  }
  if (!cascades.empty()) weights.push_back(left);
  return weights;
}

double blendedIrradiance(std::span<const Volume> cascades, const CascadeBlend& blend, const glm::dvec3& point,
                         const glm::dvec3& normal, const LookupOptions& options) {
  const std::vector<double> weights = blendWeights(cascades, blend, point, options.normalOffset);
  double sum = 0.0;
  for (std::size_t k = 0; k < cascades.size(); ++k) {
    if (weights[k] > 0.0) sum += weights[k] * irradiance(cascades[k], point, normal, options);
  }
  return sum;
}

// ---- the grid that follows the camera ------------------------------------------------------------------------------

SnappedGrid cameraGrid(const glm::dvec3& camera, const glm::dvec3& viewDirection, const glm::ivec3& dims,
                       double cellSize, SnapRule rule) {
  const glm::dvec3 extent = glm::dvec3(dims) * cellSize;
  const glm::dvec3 centre = camera + viewDirection * (0.8 * 0.5 * extent);
  const glm::dvec3 inCells = (centre - 0.5 * extent) / cellSize;
  SnappedGrid snapped;
  snapped.grid.dims = dims;
  snapped.grid.cellSize = cellSize;
  for (int axis = 0; axis < 3; ++axis) {
    const double whole = rule == SnapRule::floor ? std::floor(inCells[axis]) : std::trunc(inCells[axis] + 0.5);
    snapped.corner[axis] = static_cast<std::int64_t>(whole);
    const double minimum = static_cast<double>(snapped.corner[axis]) * cellSize;
    snapped.grid.minimum[axis] = rule == SnapRule::floor ? minimum : std::trunc(minimum);
  }
  return snapped;
}

// ---- VPLs of a lit plate -------------------------------------------------------------------------------------------

double OrthographicRsm::texelArea() const {
  return width * height / (static_cast<double>(texels.x) * static_cast<double>(texels.y));
}

OrthographicRsm fittedRsm(const Plate& plate, const glm::ivec2& texels, const glm::dvec3& irradiance) {
  OrthographicRsm rsm;
  rsm.centre = plate.centre;
  rsm.width = std::abs(plate.edgeU.x);
  rsm.height = std::abs(plate.edgeV.y);
  rsm.texels = texels;
  rsm.irradiance = irradiance;
  return rsm;
}

Plate tiltedPlate(const glm::dvec3& centre, double sizeU, double sizeV, double tilt, const glm::dvec3& albedo) {
  return {centre, {sizeU, 0.0, 0.0}, sizeV * glm::dvec3(0.0, std::cos(tilt), std::sin(tilt)), albedo};
}

std::vector<Vpl> plateVpls(const Plate& plate, const OrthographicRsm& rsm) {
  glm::dvec3 normal = glm::normalize(glm::cross(plate.edgeU, plate.edgeV));
  double cosine = -glm::dot(normal, rsm.direction());
  if (cosine < 0.0) {
    normal = -normal;
    cosine = -cosine;
  }
  std::vector<Vpl> vpls;
  if (!(cosine > 0.0)) return vpls;  // edge on: no texel sees it
  const glm::dvec3 vplFlux = rsm.irradiance * plate.albedo * rsm.texelArea();
  vpls.reserve(static_cast<std::size_t>(rsm.texels.x) * static_cast<std::size_t>(rsm.texels.y));
  for (int j = 0; j < rsm.texels.y; ++j) {
    for (int i = 0; i < rsm.texels.x; ++i) {
      const double right = ((i + 0.5) / rsm.texels.x - 0.5) * rsm.width;
      const double up = ((j + 0.5) / rsm.texels.y - 0.5) * rsm.height;
      const glm::dvec3 origin = rsm.centre + right * rsm.right + up * rsm.up;
      const double distance = glm::dot(plate.centre - origin, normal) / -cosine;
      const glm::dvec3 hit = origin + distance * rsm.direction();
      const glm::dvec3 local = hit - plate.centre;
      const double u = glm::dot(local, plate.edgeU) / glm::dot(plate.edgeU, plate.edgeU);
      const double v = glm::dot(local, plate.edgeV) / glm::dot(plate.edgeV, plate.edgeV);
      if (std::abs(u) > 0.5 || std::abs(v) > 0.5) continue;
      vpls.push_back({hit, normal, vplFlux, rsm.texelArea() / cosine});
    }
  }
  return vpls;
}

}  // namespace lucerna::reference
