#pragma once

#include <functional>
#include <vector>

#include "reconstruct/level_set/level_set.h"
#include "reconstruct/solve/ssd_sample.h"

namespace umtet {

class SsdBand;

/// Report of the solve in one band.
struct BandReport {
  double spacing = 0;         ///< spacing of the level's lattice, model units
  double smoothing = 0;       ///< smoothing c used
  std::size_t n_samples = 0;  ///< merged samples in the fit
  std::size_t n_nodes = 0;    ///< unknowns
  int iterations = 0;
  double residual = 1;  ///< final relative residual, in the norm of D^-1
  bool converged = true;
};

/// The samples in cells that their own density allows a lattice to resolve. In such a cell at least one sample
/// represents an area, and has others around it in an area, of at most `most_area` h². Elsewhere a finer lattice would
/// only dent the surface around each sample.
/// @param samples  in block order (merge_samples()), lattice units, w_gradient = area / h²; the order is kept. An
///                 rvalue is not copied
std::vector<SsdSample> resolved_samples(std::vector<SsdSample> samples, double most_area);

/// Communication between solvers of parts of one band in several processes.
class OtherParts {
 public:
  virtual ~OtherParts() = default;
  /// Sum over all blocks of the band in their order, which is the order of the parts; the result is the same in all
  /// processes.
  /// @param of_blocks  values of own blocks
  virtual double sum(const std::vector<double>& of_blocks) = 0;
  /// Receives the values of the blocks next to own ones from their owners. @param values  LatticeBlocks::kNodes per
  /// block
  virtual void fill(float* values) = 0;
};

/// Computes the correction that refine() adds.
/// @param others  null: the band is complete
/// @return coefficients in model units, LatticeBlocks::kNodes per block of the band; only those of own blocks are valid
std::vector<float> band_correction(const SsdBand& band, const LevelSet& psi, double tolerance, int max_iterations,
                                   const std::function<void(double residual)>& go_on, BandReport& report,
                                   OtherParts* others = nullptr);

/// One step of the multilevel fit: the correction g on the lattice of half psi's spacing that minimises
///   ½ Σ w_v (psi + g − v)² + ½ Σ w_g |∇psi + ∇g − n|² + ½ kappa ∫ H(psi + g) : H(psi + g)     (units of that lattice)
/// over the nodes whose functions meet a sample, by conjugate gradients with the diagonal as preconditioner.
/// @param samples  resolved samples of the finer lattice, not empty
/// @param go_on    called once per iteration with the relative residual; its exceptions are passed on
/// @return psi with the new band
LevelSet refine(const LevelSet& psi, const std::vector<SsdSample>& samples, double kappa, double tolerance,
                int max_iterations, const std::function<void(double residual)>& go_on, BandReport& report);

/// Interface for making the bands of a fit, if several processes share the work.
class BandRefiner {
 public:
  virtual ~BandRefiner() = default;
  /// Stores the samples of a band that is refined later. They replace earlier samples of this level.
  /// @param level    1, 2, ..., as in LevelSet::band()
  /// @param samples  samples for refine(), in the units of this lattice
  virtual void take(int level, const Lattice& lattice, int half_width, std::vector<SsdSample> samples) = 0;
  /// Result of umtet::refine() for the samples of level psi.n_levels(), to the bit; the samples are then freed.
  virtual LevelSet refine(const LevelSet& psi, double kappa, double tolerance, int max_iterations,
                          const std::function<void(double residual)>& go_on, BandReport& report) = 0;
};

}  // namespace umtet
