#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/context.h"
#include "common/message.h"
#include "reconstruct/basis/lme_prior.h"
#include "reconstruct/cloud/neighbours/cloud_neighbours.h"
#include "reconstruct/cloud/point_cloud.h"
#include "reconstruct/level_set/level_set.h"
#include "reconstruct/solve/closing.h"
#include "reconstruct/solve/multilevel_fit.h"
#include "reconstruct/solve/solve_error.h"

namespace umtet {

/// Weights of the samples.
enum class SsdWeights { Area, Paper };  ///< a_i by area and scale-free; or eq. (10) taken literally
/// Solver of fit_ssd().
enum class SsdSolver {
  Multilevel,  ///< full solve on a coarse lattice, corrections in bands of finer ones: the cost follows the surface
  Full,        ///< one full lattice: matrix-free PCG + V-cycle
  Assembled,   ///< one full lattice: sparse LDLT (small problems)
};

/// Parameters of fit_ssd().
struct SsdParams {
  double spacing = 0;  ///< spacing of the finest lattice, model units; 0: chosen from spacing and noise of the samples
  double smoothing = 0;  ///< c of ½ Σ a (f²/l² + |∇f − n|²) + (c h / 2) ∫ H:H (SsdWeights::Area); 0: from the noise
  double noise = 0;  ///< standard deviation of the samples along the normal, model units; l: see resolution.h
  std::vector<double> local_noise = {};  ///< noise of each sample (local_noise.h); empty: `noise` everywhere
  double detail = 1;                     ///< > 0: divides the chosen spacing
  double finest = 0;  ///< least useful spacing, model units, except for a full lattice of coarsest_nodes; >= 0
  double smooth = 1;  ///< > 0: multiplies the chosen smoothing
  double alpha =
      1e-2;  ///< alpha of eq. (10), in its units; > 0 (SsdWeights::Paper); below 1e-2 the duck grows spurious parts
  SsdWeights weights = SsdWeights::Area;  ///< Paper: on a full lattice only
  LmePrior prior;                         ///< choice of max-ent functions; Gaussian: on a full lattice only
  SsdSolver solver = SsdSolver::Multilevel;
  double tolerance = 1e-4;  ///< relative residual at which PCG stops on a full lattice; in a multilevel fit without
                            ///< bands at five times this (psi is then < .0004 h rms off); in (0, 1)
  double band_tolerance =
      0.1;  ///< the same for the bands of the multilevel fit, relative to the residual of the coarser levels
  int max_iterations = 200;         ///< >= 1
  int coarsest_nodes = 150000;      ///< maximum number of nodes of the full lattice of the multilevel fit, which shows
                                    ///< every part of a body; > 0
  Closing closing = Closing::Auto;  ///< closing of regions without samples; SsdSolver::Multilevel only
  double max_memory = 0;            ///< maximum memory of a fit in bytes; 0: no limit
  int padding =
      5;  ///< lattice cells around the cloud's box; >= 1, and >= 4 for the mesher: projections fail at the hull
  bool bounded = false;  ///< the samples are known to be the complete boundary of a body: if psi < 0 reaches the wall,
                         ///< psi is fitted again with wall_samples(); SsdSolver::Multilevel only
  BandRefiner* bands = nullptr;  ///< makes the bands of SsdSolver::Multilevel; null: refine()
};

/// All broken constraints, not just the first; empty if the parameters are valid.
std::vector<std::string> problems(const SsdParams&);

/// Report of fit_ssd().
struct SsdReport {
  std::size_t n_points = 0, n_nodes = 0;
  double spacing = 0;          ///< spacing h of the finest lattice
  double smoothing = 0;        ///< c used on the full lattice
  std::string reason;          ///< reason for spacing and smoothing, if they were chosen here
  bool noise_decided = false;  ///< the spacing would be smaller without noise
  double cloud_spacing = 0;    ///< median distance to the nearest sample
  int iterations = 0;
  std::vector<double> residuals;  ///< relative residuals on the full lattice, one per iteration, the first is 1
  std::vector<BandReport> bands;  ///< the finer levels of the multilevel fit, coarse to fine
  double energy_value = 0, energy_normal = 0;  ///< the data terms of the functional at psi
  double energy_hessian = 0;  ///< third term of the functional; 0 for every SsdSolver::Multilevel: not computed
  double rms_value = 0;       ///< rms of psi(x_i), model units; for merged samples before merging, by their spread
  double normal_defect = 0;  ///< mean of |grad psi(x_i) - n_i|^2 by area: .27 for normals 30 degrees off, 1 without any
  std::size_t n_opposed_normals = 0;  ///< samples with n_i . grad psi(x_i) < 0: the normals disagree with one another
  std::size_t n_turned_normals = 0;   ///< normals turned by earlier fits (turned_fit.h), counted each time
  std::vector<FittedHole> holes;      ///< holes of the scan, if psi was examined for them: in SsdSolver::Multilevel
  double least_wall_value = 0;        ///< least psi sampled on the wall of its domain; < 0: the body is not bounded
};

/// Error for a fit that would exceed the memory limit; what() states the need, the limit and the remedy.
struct SolveTooLarge : ExplainedError {
  using ExplainedError::ExplainedError;
};

/// Result of fit_ssd().
struct SsdFit {
  LevelSet psi;
  SsdReport report;
};

/// Smooth signed distance (SSD) surface reconstruction: fits psi = argmin E_P, eqs. (10), (11), over tensor-product
/// max-ent functions on cubic lattices.
///
/// Samples may be in any order; samples sorted in space (morton_order.h) are found faster. Reports the steps "weights",
/// "setup", "solve" and "refine", which share [0, 1] approximately in proportion to their times.
/// @param near  neighbour distances of the points, over kAreaNeighbours, with their covering (covering.h); null:
///              computed here
/// \throw std::invalid_argument for broken parameters, fewer than 10 points, all points at one position, or a `near` of
///        other points
/// \throw std::length_error for a spacing so small that a full lattice cannot hold its nodes
/// \throw SolveTooLarge if more than max_memory is needed; thrown before memory is allocated
/// \throw SolveError if the iteration does not converge, the problem is too large for the assembled solver, or the
///        spacing exceeds the cloud's size
/// \throw Cancelled
SsdFit fit_ssd(const OrientedPointCloud&, const SsdParams& = {}, const Context& = {},
               const NeighbourDistances* near = nullptr);

}  // namespace umtet
