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
  std::vector<SsdSample> samples;  ///< samples at which a basis function of an own block is nonzero, in block order
  std::size_t n_samples;           ///< number of samples of the whole band; set on rank 0
};

/// Distributes the samples of a band to the ranks of their blocks. Collective.
/// @param lattice, half_width  as for the band; used on rank 0 only
/// @param samples              samples of the band in block order; used on rank 0 only
BandPart band_part(MPI_Comm comm, const Lattice& lattice, int half_width, std::vector<SsdSample> samples);

/// Distributed version of refine(), with the same result to the bit for any number of ranks and threads. Each rank has
/// consecutive blocks of the band and the samples that they require; the coefficients are sent to all ranks.
/// Collective.
/// @param psi      the same on all ranks; no other thread may evaluate it during the call
/// @param part     result of band_part() on a lattice of half the spacing of psi
/// @param go_on    called on rank 0 with the residual
/// @param report   result, set on rank 0
LevelSet refine_parts(MPI_Comm comm, const LevelSet& psi, BandPart part, const RefineParams& params,
                      const std::function<void(double residual)>& go_on, BandReport& report);

}  // namespace umtet
