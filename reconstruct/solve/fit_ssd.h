#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/context.h"
#include "reconstruct/basis/lme_prior.h"
#include "reconstruct/cloud/cloud_neighbours.h"
#include "reconstruct/cloud/point_cloud.h"
#include "reconstruct/level_set/level_set.h"
#include "reconstruct/solve/closing.h"
#include "reconstruct/solve/multilevel_fit.h"
#include "reconstruct/solve/solve_error.h"

namespace umtet {

enum class SsdWeights { Area, Paper };  ///< a_i by area and scale-free; or eq. (10) taken literally
enum class SsdSolver {
  Multilevel,  ///< full solve on a coarse lattice, corrections in bands of finer ones: the cost follows the surface
  Full,        ///< one full lattice: matrix-free PCG + V-cycle
  Assembled,   ///< one full lattice: sparse LDLT (small problems)
};

struct SsdParams {
  double spacing = 0;  ///< of the finest lattice, model units; 0: chosen from spacing and noise of the samples
  double smoothing = 0;  ///< c of ½ Σ a (f²/l² + |∇f − n|²) + (c h / 2) ∫ H:H (SsdWeights::Area); 0: from the noise
  double noise = 0;  ///< standard deviation of the samples along the normal, model units; l: see resolution.h
  std::vector<double> local_noise = {};  ///< of each sample (local_noise.h); empty: as above everywhere
  double detail = 1;                     ///< > 0: divides the spacing that is chosen
  double finest =
      0;  ///< no lattice of a smaller spacing is of use, model units, but a full one of coarsest_nodes; >= 0
  double smooth = 1;  ///< > 0: multiplies the smoothing that is chosen
  double alpha =
      1e-2;  ///< alpha of eq. (10), in its units; > 0 (SsdWeights::Paper); below, the duck grows spurious parts
  SsdWeights weights = SsdWeights::Area;  ///< Paper: only on a full lattice
  LmePrior prior;                         ///< which max-ent functions; Gaussian: only on a full lattice
  SsdSolver solver = SsdSolver::Multilevel;
  double tolerance = 1e-4;  ///< PCG on a full lattice stops at this relative residual, in a multilevel fit without
                            ///< bands at five times as much (psi is then < .0004 h rms off); in (0, 1)
  double band_tolerance =
      0.1;  ///< the same on the bands of the multilevel fit, for the part the coarser levels leave over
  int max_iterations = 200;  ///< >= 1
  int coarsest_nodes =
      150000;  ///< most nodes of the full lattice of the multilevel fit: what shows every part of a body; > 0
  Closing closing = Closing::Auto;  ///< of what no sample shows; only of SsdSolver::Multilevel
  double max_memory = 0;            ///< bytes that fitting may take; 0: no limit
  int padding =
      5;  ///< lattice cells around the cloud's box; >= 1, and >= 4 for the mesher: projections fail at the hull
  bool bounded = false;  ///< the samples are known to be all of the boundary of a body: where psi < 0 reaches the wall,
                         ///< it is fitted again with wall_samples(); only of SsdSolver::Multilevel
  BandRefiner* bands = nullptr;  ///< makes those of SsdSolver::Multilevel; null: refine()
};

/// Every broken constraint, not just the first; empty when the parameters are usable.
std::vector<std::string> problems(const SsdParams&);

struct SsdReport {
  std::size_t n_points = 0, n_nodes = 0;
  double spacing = 0;          ///< h used, of the finest lattice
  double smoothing = 0;        ///< c used on the full lattice
  std::string reason;          ///< why this spacing and smoothing, when they were chosen here
  bool noise_decided = false;  ///< without noise the spacing would be smaller
  double cloud_spacing = 0;    ///< median distance to the nearest sample
  int iterations = 0;
  std::vector<double> residuals;               ///< of the full lattice: relative, one per iteration, the first is 1
  std::vector<BandReport> bands;               ///< the finer levels of the multilevel fit, coarse to fine
  double energy_value = 0, energy_normal = 0;  ///< the data terms of the functional at psi
  double energy_hessian = 0;                   ///< its third term; 0 for every SsdSolver::Multilevel: not computed
  double rms_value = 0;  ///< rms of psi(x_i), model units; of merged samples before they were merged, by their spread
  double normal_defect = 0;  ///< mean of |grad psi(x_i) - n_i|^2 by area: .27 for normals 30 degrees off, 1 without any
  std::size_t n_opposed_normals = 0;  ///< samples with n_i . grad psi(x_i) < 0: the normals disagree with one another
  std::size_t n_turned_normals = 0;   ///< by earlier fits (turned_fit.h), each time one was counted
  std::vector<FittedHole> holes;      ///< of the scan, where psi was looked at for them: in SsdSolver::Multilevel
  double least_wall_value = 0;        ///< least psi sampled on the wall of its domain; < 0: the body has no end
};

/// What a fit would need and may not have; what() says both, and the remedy.
struct SolveTooLarge : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct SsdFit {
  LevelSet psi;
  SsdReport report;
};

/// Fits psi = argmin E_P, eqs. (10), (11), over tensor-product max-ent functions on cubic lattices. Samples may come in
/// any order; sorted in space (morton_order.h) they are faster to look up.
/// @param near  of the points, over kAreaNeighbours, with their covering (covering.h); null: searched here
/// \throw std::invalid_argument  broken parameters, fewer than 10 points, all points at one place, `near` of other ones
/// \throw std::length_error      a spacing so small that a full lattice cannot hold its nodes
/// \throw SolveTooLarge          more than max_memory is needed; said before it is taken
/// \throw SolveError             not converged, too large for the assembled solver, or a spacing beyond the cloud's
///                               size
/// \throw Cancelled
/// Reports the steps "weights", "setup", "solve" and "refine", which share [0, 1] about as their times do.
SsdFit fit_ssd(const OrientedPointCloud&, const SsdParams& = {}, const Context& = {},
               const NeighbourDistances* near = nullptr);

}  // namespace umtet
