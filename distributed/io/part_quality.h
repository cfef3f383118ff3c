#pragma once

#include <mpi.h>

#include <string>
#include <utility>
#include <vector>

#include "distributed/distributed_mesh.h"
#include "mesh/io/quality_csv.h"

namespace umtet {

/// Lines of quality.csv.
struct QualitySamples {
  std::vector<std::size_t> indices;
  std::vector<SampledCurve> curves;
};
/// The quality_vectors() of what all ranks have at some stages, at the indices of write_quality_csv(): those of the
/// mesh, stage by stage, then those of its tets with a positive vertex, boundary_STAGE. Collective; the same on all
/// ranks.
/// @param mesh    has other places meanwhile
/// @param stages  names, and the places of the vertices of the own mesh; as they were at the end
QualitySamples quality_samples(MPI_Comm comm, DistributedMesh& mesh,
                               const std::vector<std::pair<std::string, std::vector<Vec3>*>>& stages);

}  // namespace umtet
