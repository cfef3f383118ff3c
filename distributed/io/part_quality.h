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
/// Returns samples of the quality_vectors() of the whole mesh at some stages, at the indices of write_quality_csv().
/// For each stage there is a curve of all tets; curves named boundary_STAGE, of the tets with a positive vertex,
/// follow. Collective; the result is the same on all ranks.
/// @param mesh    local mesh; its positions change during the call
/// @param stages  name of each stage, and the positions of the local vertices, which are unchanged after the call
QualitySamples quality_samples(MPI_Comm comm, DistributedMesh& mesh,
                               const std::vector<std::pair<std::string, std::vector<Vec3>*>>& stages);

}  // namespace umtet
