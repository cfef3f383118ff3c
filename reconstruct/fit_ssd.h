#pragma once

#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "reconstruct/level_set.h"
#include "reconstruct/lme_prior.h"
#include "reconstruct/point_cloud.h"
#include "reconstruct/solve_error.h"

namespace umtet {

enum class SsdWeights { Area, Paper };          ///< a_i by area and scale-free; or eq. (10) taken literally
enum class SsdSolver { Multigrid, Assembled };  ///< matrix-free PCG + V-cycle; or sparse LDLT (small problems)

struct SsdParams {
  double spacing = 0;       ///< lattice spacing h, model units; 0: chosen from the cloud's spacing and size
  double smoothing = 0.01;  ///< c of ½ Σ a (f²/h² + |∇f − n|²) + (c h / 2) ∫ H:H; > 0 (SsdWeights::Area)
  double alpha =
      1e-2;  ///< alpha of eq. (10), in its units; > 0 (SsdWeights::Paper); below, the duck grows spurious parts
  SsdWeights weights = SsdWeights::Area;
  LmePrior prior;  ///< which max-ent functions
  SsdSolver solver = SsdSolver::Multigrid;
  double tolerance = 1e-5;   ///< PCG stops at this relative residual (psi then moves by < 1e-5 h); in (0, 1)
  int max_iterations = 200;  ///< >= 1
  int padding =
      5;  ///< lattice cells around the cloud's box; >= 1, and >= 4 for the mesher: projections fail at the hull
};

/// Every broken constraint, not just the first; empty when the parameters are usable.
std::vector<std::string> problems(const SsdParams&);

struct SsdReport {
  std::size_t n_points = 0, n_nodes = 0;
  double spacing = 0;        ///< h used
  double cloud_spacing = 0;  ///< median distance to the nearest sample
  int iterations = 0;
  std::vector<double> residuals;                                   ///< relative, one per iteration, the first is 1
  double energy_value = 0, energy_normal = 0, energy_hessian = 0;  ///< the three terms of the functional at psi
  double rms_value = 0;                                            ///< rms of psi(x_i), model units
  std::size_t n_opposed_normals = 0;  ///< samples with n_i . grad psi(x_i) < 0: the normals disagree with one another
  double least_wall_value = 0;        ///< least psi sampled on the wall of its domain; < 0: the body has no end
};

/// Where the stage stands: "weights", "setup", "solve"; fraction in [0, 1]. Return false to stop: SolveCancelled.
using SsdProgress = std::function<bool(const char* step, double fraction)>;
struct SolveCancelled : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct SsdFit {
  LevelSet psi;
  SsdReport report;
};

/// Fits psi = argmin E_P, eqs. (10), (11), over tensor-product max-ent functions on a cubic lattice.
/// \throw std::invalid_argument  broken parameters, fewer than 10 points, all points at one place
/// \throw std::length_error      a spacing that asks for more nodes than a full lattice can hold
/// \throw SolveError             not converged, too large for the assembled solver, or a spacing beyond the cloud's size
/// \throw SolveCancelled         `progress` said stop
SsdFit fit_ssd(const OrientedPointCloud&, const SsdParams& = {}, const SsdProgress& = {});

}  // namespace umtet
