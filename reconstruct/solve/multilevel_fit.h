#pragma once

#include <functional>
#include <vector>

#include "reconstruct/level_set/level_set.h"
#include "reconstruct/solve/ssd_sample.h"

namespace umtet {

class SsdBand;

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
/// @param samples  in block order (merge_samples), lattice units, w_gradient = area / h²; the order is kept. Given
/// away, they are not copied.
std::vector<SsdSample> resolved_samples(std::vector<SsdSample> samples, double most_area);

/// What the solver of a part of a band needs of those of the others, where several processes solve one.
class OtherParts {
 public:
  virtual ~OtherParts() = default;
  /// The sum over all blocks of the band in their order, which is that of the parts: the same for all.
  /// @param of_blocks  own ones
  virtual double sum(const std::vector<double>& of_blocks) = 0;
  /// Values of the blocks next to the own ones, from those who own them. @param values  LatticeBlocks::kNodes a block
  virtual void fill(float* values) = 0;
};

/// The correction that refine() adds.
/// @param others  null: the band is whole
/// @return coefficients in model units, LatticeBlocks::kNodes a block of the band; those of own blocks count
std::vector<float> band_correction(const SsdBand& band, const LevelSet& psi, double tolerance, int max_iterations,
                                   const std::function<void(double residual)>& go_on, BandReport& report,
                                   OtherParts* others = nullptr);

/// One step of the multilevel fit: the correction g on the lattice of half psi's spacing that minimises
///   ½ Σ w_v (psi + g − v)² + ½ Σ w_g |∇psi + ∇g − n|² + ½ kappa ∫ H(psi + g) : H(psi + g)     (units of that lattice)
/// over the nodes whose functions meet a sample, by conjugate gradients with the diagonal as preconditioner.
/// @param samples  resolved samples of the finer lattice, not empty
/// @param go_on    called once an iteration with the relative residual; what it throws passes through
/// @return psi with the band
LevelSet refine(const LevelSet& psi, const std::vector<SsdSample>& samples, double kappa, double tolerance,
                int max_iterations, const std::function<void(double residual)>& go_on, BandReport& report);

/// Makes the steps of a fit, where that is not this process alone.
class BandRefiner {
 public:
  virtual ~BandRefiner() = default;
  /// Keeps the samples of a band, which is refined later, in the place of those that it had of this level.
  /// @param level  1, 2, ...: that of LevelSet::band()
  /// @param samples  of refine(), in the units of this lattice
  virtual void take(int level, const Lattice& lattice, int half_width, std::vector<SsdSample> samples) = 0;
  /// What refine() makes of the samples of level psi.n_levels(), to the bit; they are gone then.
  virtual LevelSet refine(const LevelSet& psi, double kappa, double tolerance, int max_iterations,
                          const std::function<void(double residual)>& go_on, BandReport& report) = 0;
};

}  // namespace umtet
