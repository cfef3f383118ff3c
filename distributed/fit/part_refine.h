#pragma once

#include <mpi.h>

#include <functional>
#include <vector>

#include "reconstruct/solve/multilevel_fit.h"

namespace umtet {

/// Parameters of a step of the multilevel fit, known to all ranks.
struct RefineParams {
  double kappa, tolerance;
  int max_iterations;
};

/// The part of a band on a rank.
struct BandPart {
  LatticeBlocks blocks;            ///< all blocks of the band
  std::vector<int> begin;          ///< result of cut_band(): first block of each rank
  std::vector<SsdSample> samples;  ///< samples with a function in an own block, in block order
  std::size_t n_samples;           ///< number of samples of the band; on rank 0
};

/// Distributes the samples of a band to the ranks of their blocks. Collective.
/// @param lattice, half_width  read on rank 0, like the samples, which are in block order
BandPart band_part(MPI_Comm comm, const Lattice& lattice, int half_width, std::vector<SsdSample> samples);

/// Distributed version of refine(), with the same result to the bit for any number of ranks and threads. Each rank has
/// consecutive blocks of the band and the samples whose functions belong to them; the coefficients are sent to all.
/// Collective.
/// @param psi      the same on all ranks; no other thread may evaluate it during the call
/// @param part     on the lattice of half psi's spacing
/// @param go_on    called on rank 0
/// @param report   set on rank 0
LevelSet refine_parts(MPI_Comm comm, const LevelSet& psi, BandPart part, const RefineParams& params,
                      const std::function<void(double residual)>& go_on, BandReport& report);

}  // namespace umtet
