#pragma once

#include <mpi.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "distributed/lattice_part.h"
#include "distributed/partition.h"
#include "mesh/classification/classification.h"
#include "mesh/core/implicit_function.h"
#include "mesh/fast/repair.h"

namespace umtet {

/// What repair has changed, by ids of the whole, ascending; the same on all ranks.
struct PartRepair {
  std::vector<std::int64_t> flipped;
  std::vector<std::pair<std::int64_t, Vec3>> moved;
  std::size_t n_gets = 0, bytes = 0;  ///< that rank 0 has read of others, and 0 elsewhere
  std::size_t psi_evaluations = 0;    ///< of this rank: most are of rank 0
};

/// Where a layer has the vertices that move, ascending.
std::vector<std::pair<std::int64_t, Vec3>> places_of(const BackgroundLayer& layer);

/// repair() of the layer that all ranks have together. How many patches it tries is bounded, whatever the size of the
/// mesh, and which ones depends on how many were tried before: so rank 0 does it, and reads the blocks around bad tets
/// from those that have them. It holds a bit for each vertex of the background.
///
/// Collective. @param layer  of own vertices, smoothed, with the places of others up to date
PartRepair repair_parts(MPI_Comm comm, const LatticePart& part, const Partition& partition, ImplicitFunctionRef psi,
                        const ClassificationParams& classification, const RepairParams& params,
                        const BackgroundLayer& layer, const IdSet& inside);

}  // namespace umtet
