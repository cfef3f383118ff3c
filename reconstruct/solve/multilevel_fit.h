#pragma once

#include <functional>
#include <vector>

#include "reconstruct/level_set/level_set.h"
#include "reconstruct/solve/ssd_sample.h"

namespace umtet {

struct BandReport {
  double spacing = 0;         ///< of the level's lattice, model units
  double smoothing = 0;       ///< c used
  std::size_t n_samples = 0;  ///< merged samples that were fitted
  std::size_t n_nodes = 0;    ///< unknowns
  int iterations = 0;
  double residual = 1;  ///< reached, relative, in the norm of D^-1
  bool converged = true;
};

/// Samples of the cells that their own density lets a lattice resolve: those of which at least one sample stands for an
/// area, and has others around it in an area, of at most `most_area` h². Elsewhere a finer lattice would only dent the
/// surface around each sample.
/// @param samples  in block order (merge_samples), lattice units, w_gradient = area / h²; the order is kept
std::vector<SsdSample> resolved_samples(const std::vector<SsdSample>& samples, double most_area);

/// One step of the multilevel fit: the correction g on the lattice of half psi's spacing that minimises
///   ½ Σ w_v (psi + g − v)² + ½ Σ w_g |∇psi + ∇g − n|² + ½ kappa ∫ H(psi + g) : H(psi + g)     (units of that lattice)
/// over the nodes whose functions meet a sample, by conjugate gradients with the diagonal as preconditioner.
/// @param samples  resolved samples of the finer lattice, not empty
/// @param go_on    called once an iteration with the relative residual; what it throws passes through
/// @return psi with the band
LevelSet refine(const LevelSet& psi, const std::vector<SsdSample>& samples, double kappa, double tolerance,
                int max_iterations, const std::function<void(double residual)>& go_on, BandReport& report);

}  // namespace umtet
