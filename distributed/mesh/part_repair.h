#pragma once

#include <mpi.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "distributed/partition/lattice_part.h"
#include "distributed/partition/partition.h"
#include "mesh/classification/classification.h"
#include "mesh/core/implicit_function.h"
#include "mesh/fast/repair/repair.h"

namespace umtet {

/// Changes made by repair, with ids of the whole lattice, ascending; the same on all ranks.
struct PartRepair {
  std::vector<std::int64_t> flipped;
  std::vector<std::pair<std::int64_t, Vec3>> moved;
  std::size_t n_gets = 0, bytes = 0;  ///< reads of other ranks by rank 0; 0 elsewhere
  std::size_t psi_evaluations = 0;    ///< number on this rank; most are on rank 0
};

/// Returns the positions of the vertices of a layer that move, ascending.
std::vector<std::pair<std::int64_t, Vec3>> places_of(const BackgroundLayer& layer);

/// Distributed version of repair(), for the layer of all ranks together. The number of patches tried is bounded for any
/// size of the mesh, and the choice of patches depends on the number tried before. Rank 0 therefore runs it, and reads
/// the blocks around bad tets from the ranks that have them. It stores a bit per vertex of the background.
///
/// Collective.
/// @param layer  smoothed layer of own vertices, with the present positions of the others
PartRepair repair_parts(MPI_Comm comm, const LatticePart& part, const Partition& partition, ImplicitFunctionRef psi,
                        const ClassificationParams& classification, const RepairParams& params,
                        const BackgroundLayer& layer, const IdSet& inside);

}  // namespace umtet
