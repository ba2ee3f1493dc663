#include "radiosity/solvers.hpp"

#include "base/error.hpp"
#include "radiosity/form_factor_matrix.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>

namespace lucerna {

namespace {

using Vector = std::vector<glm::dvec3>;

glm::dvec3 largest(std::span<const glm::dvec3> v) {
  glm::dvec3 most(0.0);
  for (const glm::dvec3& x : v) most = glm::max(most, glm::abs(x));
  return most;
}

/// Shared by all solvers: the system, the error bound, the count.
class Solve {
 public:
  Solve(const RadiositySystem& system, const SolverSettings& settings)
      : system_(system), settings_(settings), n_(system.areas.size()) {
    result_.exitance = system.emission;
    result_.irradiance.assign(n_, glm::dvec3(0.0));
    double leaks = 0.0;
    glm::dvec3 lost(0.0);
    for (std::size_t i = 0; i < n_; ++i) {
      q_ = glm::max(q_, system.reflectance[i] * system.rowSums[i]);
      lost += system.areas[i] * (1.0 - system.reflectance[i] * system.rowSums[i]);
      leaks += system.areas[i] * (1.0 - system.rowSums[i]);
      area_ += system.areas[i];
    }
    for (int c = 0; c < 3; ++c) {
      if (largest(system.emission)[c] == 0.0) q_[c] = 0.0;  // dark: the solution is 0 for any reflectance
      if (q_[c] < 1.0) {
        factor_[c] = q_[c] / (1.0 - q_[c]);
      } else if (lost[c] < 1e-7 * area_) {
        throwBadInput(
            "reflectance 1 everywhere in a closed scene ({:.2g} of the light gets out): what is emitted can never be "
            "absorbed, so there is no "
            "solution; lower a reflectance or open the scene",
            leaks / area_);
      } else {
        factor_[c] = -1.0;
      }
    }
    if (std::min({factor_.x, factor_.y, factor_.z}) < 0.0) boundBySupersolution();
  }

  RadiositySolved take(RadiositySolver solver) {
    result_.solver = solver;
    return std::move(result_);
  }

  std::size_t size() const { return n_; }
  /// The irradiance to begin with. In a dark channel the bound knows of no other than 0.
  Vector start() const {
    Vector start(settings_.start.begin(), settings_.start.end());
    start.resize(n_, glm::dvec3(0.0));
    const glm::dvec3 most = largest(system_.emission);
    for (glm::dvec3& irradiance : start)
      for (int c = 0; c < 3; ++c)
        if (most[c] == 0.0) irradiance[c] = 0.0;
    return start;
  }
  bool hasStart() const { return !settings_.start.empty(); }
  const RadiositySystem& system() const { return system_; }

  void product(const Vector& exitance, Vector& irradiance) {
    system_.product(exitance, irradiance);
    result_.progress.products += 1.0;
  }
  void countRow() { result_.progress.products += 1.0 / static_cast<double>(n_); }

  /// The bound after a Jacobi step from a mean exitance, for this change.
  double boundOf(const glm::dvec3& change, const glm::dvec3& mean) const {
    double bound = 0.0;
    for (int c = 0; c < 3; ++c)
      if (change[c] > 0.0) bound = std::max(bound, mean[c] > 0.0 ? factor_[c] * change[c] / mean[c] : 1e300);
    return bound;
  }
  glm::dvec3 meanOf(const Vector& exitance) const {
    glm::dvec3 mean(0.0);
    for (std::size_t i = 0; i < n_; ++i) mean += system_.areas[i] * exitance[i];
    return mean / area_;
  }

  /// `irradiance` = F times an exitance that differs from E + rho * irradiance by at most `change`. True: continue.
  bool report(const Vector& irradiance, const glm::dvec3& change) {
    glm::dvec3 emitted(0.0), absorbed(0.0), escaped(0.0);
    for (std::size_t i = 0; i < n_; ++i) {
      const glm::dvec3 exitance = system_.emission[i] + system_.reflectance[i] * irradiance[i];
      result_.exitance[i] = exitance;
      emitted += system_.areas[i] * system_.emission[i];
      absorbed += system_.areas[i] * (1.0 - system_.reflectance[i]) * irradiance[i];
      escaped += system_.areas[i] * (1.0 - system_.rowSums[i]) * exitance;
    }
    result_.irradiance = irradiance;
    RadiosityProgress& p = result_.progress;
    const glm::dvec3 mean = meanOf(result_.exitance);
    p.errorBound = boundOf(change, mean);
    p.residual = residualOf(change, mean);
    p.energyBalance = 0.0;
    for (int c = 0; c < 3; ++c) {
      const double off = emitted[c] > 0.0 ? (emitted[c] - absorbed[c] - escaped[c]) / emitted[c] : 0.0;
      if (std::abs(off) > std::abs(p.energyBalance)) p.energyBalance = off;
    }
    result_.reached = p.errorBound <= settings_.error;
    const bool wanted = !settings_.onStep || settings_.onStep(p);
    return wanted && !result_.reached && p.products < settings_.mostProducts;
  }

  /// Between two reports; `change` is an estimate. True: continue.
  bool goesOn(const glm::dvec3& change, const glm::dvec3& mean) const {
    RadiosityProgress p = result_.progress;
    p.errorBound = boundOf(change, mean);
    p.residual = residualOf(change, mean);
    p.isEstimate = true;
    return !settings_.onStep || settings_.onStep(p);
  }

  double error() const { return settings_.error; }
  bool spent() const { return result_.progress.products >= settings_.mostProducts; }

 private:
  static double residualOf(const glm::dvec3& change, const glm::dvec3& mean) {
    double residual = 0.0;
    for (int c = 0; c < 3; ++c)
      if (mean[c] > 0.0) residual = std::max(residual, change[c] / mean[c]);
    return residual;
  }
  /// w with (I - rho F) w >= o > 0, from an approximate solution for a right side of 1.
  void boundBySupersolution() {
    Vector w(n_, glm::dvec3(1.0)), image(n_);
    constexpr int kSweeps = 2000;
    for (int sweep = 0; sweep <= kSweeps; ++sweep) {
      product(w, image);
      glm::dvec3 least(1e300);
      for (std::size_t i = 0; i < n_; ++i) {
        const glm::dvec3 next = 1.0 + system_.reflectance[i] * image[i];
        least = glm::min(least, w[i] - system_.reflectance[i] * image[i]);
        image[i] = next;
      }
      // The iterates grow towards the solution, w - rho F w = 1 - (growth of the next step).
      const glm::dvec3 most = largest(w);
      bool done = true;
      for (int c = 0; c < 3; ++c)
        if (factor_[c] < 0.0) {
          if (least[c] > 0.5) factor_[c] = std::max(q_[c], 1.0) * most[c] / least[c];
          else done = false;
        }
      if (done) return;
      w.swap(image);
    }
    throwBadInput(
        "surfaces of reflectance 1 enclose light almost without a way out: no bound on the error was found in {} "
        "products; lower a reflectance",
        kSweeps);
  }

  const RadiositySystem& system_;
  const SolverSettings& settings_;
  std::size_t n_;
  glm::dvec3 q_{0.0}, factor_{0.0};
  double area_ = 0.0;
  RadiositySolved result_;
};

Vector jacobiStep(const RadiositySystem& s, const Vector& irradiance) {
  Vector next(irradiance.size());
  for (std::size_t i = 0; i < next.size(); ++i) next[i] = s.emission[i] + s.reflectance[i] * irradiance[i];
  return next;
}

glm::dvec3 largestDifference(const Vector& a, const Vector& b) {
  glm::dvec3 most(0.0);
  for (std::size_t i = 0; i < a.size(); ++i) most = glm::max(most, glm::abs(a[i] - b[i]));
  return most;
}

void jacobi(Solve& solve, Vector exitance) {
  Vector irradiance(solve.size());
  for (;;) {
    solve.product(exitance, irradiance);
    Vector next = jacobiStep(solve.system(), irradiance);
    if (!solve.report(irradiance, largestDifference(next, exitance))) return;
    exitance = std::move(next);
  }
}

void gaussSeidel(Solve& solve) {
  const RadiositySystem& s = solve.system();
  Vector exitance = jacobiStep(s, solve.start()), irradiance(solve.size());
  for (;;) {
    glm::dvec3 change(0.0);
    for (std::size_t i = 0; i < solve.size(); ++i) {
      const FormFactorMatrix::Row row = s.matrix->row(i);
      glm::dvec3 sum(0.0);
      for (std::size_t k = 0; k < row.patches.size(); ++k)
        sum += static_cast<double>(row.factors[k]) * exitance[row.patches[k]];
      irradiance[i] = row.scale * sum;
      const glm::dvec3 next = s.emission[i] + s.reflectance[i] * irradiance[i];
      change = glm::max(change, glm::abs(next - exitance[i]));
      exitance[i] = next;
      solve.countRow();
    }
    // The sweep's matrix has no larger norm than Jacobi's [Varga1962, section 3.1], so the same bound holds.
    if (!solve.report(irradiance, change)) return;
  }
}

/// Progressive refinement [CohenChen1988; RAD2008, section 2.2.3.1], which is Southwell's relaxation [Gortler1993]: the
/// patch with the most unshot light shoots it at all others.
void progressive(Solve& solve) {
  const RadiositySystem& s = solve.system();
  const std::size_t n = solve.size();
  const std::size_t shotsPerReport = std::max<std::size_t>(n / 10, 1);
  Vector unshot = s.emission, irradiance = solve.start();
  if (solve.hasStart()) {
    const Vector shot = jacobiStep(s, irradiance);
    solve.product(shot, irradiance);
    unshot = jacobiStep(s, irradiance);
    for (std::size_t i = 0; i < n; ++i) unshot[i] -= shot[i];
  }
  for (std::size_t shots = 1;; ++shots) {
    std::size_t best = 0;
    double most = -1.0;
    for (std::size_t i = 0; i < n; ++i) {
      const glm::dvec3 flux = glm::abs(unshot[i]) * s.areas[i];
      if (const double sum = flux.x + flux.y + flux.z; sum > most) most = sum, best = i;
    }
    const glm::dvec3 shoots = unshot[best];
    unshot[best] = glm::dvec3(0.0);
    const FormFactorMatrix::Row row = s.matrix->row(best);
    for (std::size_t k = 0; k < row.patches.size(); ++k) {
      const std::size_t j = row.patches[k];
      const glm::dvec3 arrives =
          row.scale * static_cast<double>(row.factors[k]) * s.areas[best] / s.areas[j] * shoots;  // F_ji by reciprocity
      irradiance[j] += arrives;
      unshot[j] += s.reflectance[j] * arrives;
    }
    solve.countRow();
    if (shots % shotsPerReport != 0 && !solve.spent()) continue;
    Vector exitance = jacobiStep(s, irradiance);
    // Shooting assumes exact reciprocity; the last step must include its rounding errors.
    if (solve.boundOf(largest(unshot), solve.meanOf(exitance)) <= solve.error())
      return jacobi(solve, std::move(exitance));
    if (!solve.report(irradiance, largest(unshot))) return;
  }
}

/// Solves a small dense system by elimination with row pivots; columns that vanish get 0.
std::vector<double> solveDense(std::vector<std::vector<double>> a, std::vector<double> b) {
  const std::size_t n = b.size();
  std::vector<double> x(n, 0.0);
  std::vector<bool> dead(n, false);
  double scale = 0.0;
  for (std::size_t i = 0; i < n; ++i) scale = std::max(scale, std::abs(a[i][i]));
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i)
      if (std::abs(a[i][k]) > std::abs(a[pivot][k])) pivot = i;
    std::swap(a[k], a[pivot]);
    std::swap(b[k], b[pivot]);
    dead[k] = !(std::abs(a[k][k]) > 1e-14 * scale);
    if (dead[k]) continue;
    for (std::size_t i = k + 1; i < n; ++i) {
      const double f = a[i][k] / a[k][k];
      for (std::size_t j = k; j < n; ++j) a[i][j] -= f * a[k][j];
      b[i] -= f * b[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    if (dead[k]) continue;
    double sum = b[k];
    for (std::size_t j = k + 1; j < n; ++j) sum -= a[k][j] * x[j];
    x[k] = sum / a[k][k];
  }
  return x;
}

/// Jacobi accelerated by the last few steps [WalkerNi2011], channel by channel, least squares weighted by area.
void anderson(Solve& solve) {
  constexpr std::size_t kHistory = 6;
  const RadiositySystem& s = solve.system();
  const std::size_t n = solve.size();
  Vector exitance = jacobiStep(s, solve.start()), irradiance(n), lastNext, lastChange;
  std::deque<Vector> nexts, changes;  // differences between successive steps
  for (;;) {
    solve.product(exitance, irradiance);
    const Vector next = jacobiStep(s, irradiance);
    Vector change(n);
    for (std::size_t i = 0; i < n; ++i) change[i] = next[i] - exitance[i];
    if (!solve.report(irradiance, largest(change))) return;
    if (!lastNext.empty()) {
      Vector dNext(n), dChange(n);
      for (std::size_t i = 0; i < n; ++i) dNext[i] = next[i] - lastNext[i], dChange[i] = change[i] - lastChange[i];
      nexts.push_back(std::move(dNext));
      changes.push_back(std::move(dChange));
      if (nexts.size() > kHistory) nexts.pop_front(), changes.pop_front();
    }
    lastNext = next;
    lastChange = change;
    exitance = next;
    const std::size_t m = nexts.size();
    for (int c = 0; c < 3; ++c) {
      std::vector<std::vector<double>> gram(m, std::vector<double>(m, 0.0));
      std::vector<double> right(m, 0.0);
      for (std::size_t a = 0; a < m; ++a) {
        for (std::size_t i = 0; i < n; ++i) right[a] += s.areas[i] * changes[a][i][c] * change[i][c];
        for (std::size_t b = 0; b <= a; ++b) {
          for (std::size_t i = 0; i < n; ++i) gram[a][b] += s.areas[i] * changes[a][i][c] * changes[b][i][c];
          gram[b][a] = gram[a][b];
        }
      }
      const std::vector<double> weights = solveDense(gram, right);
      for (std::size_t a = 0; a < m; ++a)
        for (std::size_t i = 0; i < n; ++i) exitance[i][c] -= weights[a] * nexts[a][i][c];
    }
  }
}

/// Conjugate gradients on H - F rho H = F E, which is self-adjoint with vectors weighted by A rho
/// [HestenesStiefel1952].
void conjugateGradients(Solve& solve) {
  const RadiositySystem& s = solve.system();
  const std::size_t n = solve.size();
  const auto dot = [&](const Vector& a, const Vector& b) {
    glm::dvec3 sum(0.0);
    for (std::size_t i = 0; i < n; ++i) sum += s.areas[i] * s.reflectance[i] * a[i] * b[i];
    return sum;
  };
  Vector h = solve.start(), r(n), p(n), weighted(n), image(n);
  double lastBound = 1e300;
  for (;;) {
    // The true residual, from a Jacobi step.
    const Vector exitance = jacobiStep(s, h);
    solve.product(exitance, image);
    glm::dvec3 change(0.0);
    for (std::size_t i = 0; i < n; ++i) {
      r[i] = image[i] - h[i];
      change = glm::max(change, glm::abs(s.reflectance[i] * r[i]));
    }
    if (!solve.report(image, change)) return;
    const double bound = solve.boundOf(change, solve.meanOf(exitance));
    if (bound > 0.5 * lastBound) return;  // the limit of double precision
    lastBound = bound;
    p = r;
    glm::dvec3 rr = dot(r, r);
    const glm::dvec3 start = rr;
    for (;;) {
      for (std::size_t i = 0; i < n; ++i) weighted[i] = s.reflectance[i] * p[i];
      solve.product(weighted, image);
      for (std::size_t i = 0; i < n; ++i) image[i] = p[i] - image[i];
      const glm::dvec3 pq = dot(p, image);
      glm::dvec3 alpha(0.0), beta(0.0);
      for (int c = 0; c < 3; ++c) alpha[c] = pq[c] > 0.0 ? rr[c] / pq[c] : 0.0;
      change = glm::dvec3(0.0);
      for (std::size_t i = 0; i < n; ++i) {
        h[i] += alpha * p[i];
        r[i] -= alpha * image[i];
        change = glm::max(change, glm::abs(s.reflectance[i] * r[i]));
      }
      const glm::dvec3 next = dot(r, r);
      // A channel that has converged to the last bits is skipped.
      for (int c = 0; c < 3; ++c) beta[c] = rr[c] > 0.0 && next[c] > 1e-30 * start[c] ? next[c] / rr[c] : 0.0;
      for (std::size_t i = 0; i < n; ++i) p[i] = r[i] + beta * p[i];
      rr = next;
      const glm::dvec3 mean = solve.meanOf(jacobiStep(s, h));
      if (!solve.goesOn(change, mean)) return;
      if (solve.boundOf(change, mean) <= 0.7 * solve.error() || solve.spent()) break;
      bool alive = false;
      for (int c = 0; c < 3; ++c) alive = alive || (pq[c] > 0.0 && rr[c] > 1e-30 * start[c]);
      if (!alive) break;
    }
  }
}

}  // namespace

RadiositySolved solveRadiosity(const RadiositySystem& system, const SolverSettings& settings) {
  Solve solve(system, settings);
  RadiositySolver solver = settings.solver;
  if (solver == RadiositySolver::automatic)
    solver = system.reciprocal ? RadiositySolver::conjugateGradients : RadiositySolver::anderson;
  const bool needsRows = solver == RadiositySolver::gaussSeidel || solver == RadiositySolver::progressive;
  if (needsRows && !system.matrix)
    throwBadInput("solver {}: needs single rows, which are not stored here; give more memory or use anderson",
                  nameOf(solver));
  if (solver == RadiositySolver::conjugateGradients && !system.reciprocal)
    throwBadInput("solver cg: needs form factors repaired to A_i F_ij = A_j F_ji; use anderson otherwise");
  switch (solver) {
    case RadiositySolver::jacobi: jacobi(solve, jacobiStep(system, solve.start())); break;
    case RadiositySolver::gaussSeidel: gaussSeidel(solve); break;
    case RadiositySolver::progressive: progressive(solve); break;
    case RadiositySolver::anderson: anderson(solve); break;
    default: conjugateGradients(solve); break;
  }
  return solve.take(solver);
}

}  // namespace lucerna
