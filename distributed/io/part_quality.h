#pragma once

#include <mpi.h>

#include <string>
#include <utility>
#include <vector>

#include "distributed/mesh/distributed_mesh.h"
#include "mesh/io/quality_csv.h"

namespace umtet {

/// Lines of the file quality.csv.
struct QualitySamples {
  std::vector<std::size_t> indices;
  std::vector<SampledCurve> curves;
};
/// The quality_vectors() of the whole mesh at some stages, at the indices of write_quality_csv(): those of all tets,
/// stage by stage, then those of the tets with a positive vertex, boundary_STAGE. Collective; the same on all ranks.
/// @param mesh    its positions change during the call
/// @param stages  names, and positions of the local vertices; unchanged at the end
QualitySamples quality_samples(MPI_Comm comm, DistributedMesh& mesh,
                               const std::vector<std::pair<std::string, std::vector<Vec3>*>>& stages);

}  // namespace umtet
