#pragma once

#include <mpi.h>

#include <functional>
#include <vector>

#include "reconstruct/solve/multilevel_fit.h"

namespace umtet {

/// What of a step of the multilevel fit all ranks know.
struct RefineParams {
  double kappa, tolerance;
  int max_iterations;
};

/// Samples of a band on all ranks.
struct BandPart {
  LatticeBlocks blocks;            ///< of the band
  std::vector<int> begin;          ///< by cut_band(): where those of each rank begin
  std::vector<SsdSample> samples;  ///< of which a function belongs to an own block, in block order
  std::size_t n_samples;           ///< of the band; on rank 0
};

/// Each rank gets the samples of its blocks. Collective.
/// @param lattice, half_width  read on rank 0, as are the samples, in block order
BandPart band_part(MPI_Comm comm, const Lattice& lattice, int half_width, std::vector<SsdSample> samples);

/// refine() by all ranks, to the bit, for any number of them and of threads. Each has consecutive blocks of the band,
/// and of the samples those whose functions belong to them; the coefficients go to all. Collective.
/// @param psi      the same on all ranks; nobody else may evaluate it meanwhile
/// @param part     of the lattice of half psi's spacing
/// @param go_on    of rank 0
/// @param report   filled on rank 0
LevelSet refine_parts(MPI_Comm comm, const LevelSet& psi, BandPart part, const RefineParams& params,
                      const std::function<void(double residual)>& go_on, BandReport& report);

}  // namespace umtet
