#pragma once

#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <vector>

#include "distributed/distributed_mesh.h"
#include "distributed/io/part_files.h"
#include "mesh/background/background_mesh.h"
#include "pipeline/meshing/part_mesher.h"

namespace umtet {

/// A rank's part of a mesh of all ranks, as files will hold it, and what all do with theirs. All functions are
/// collective.
class HeldMesh {
 public:
  HeldMesh(MPI_Comm comm, const BackgroundMesh& background, ImplicitFunctionRef psi, const FastParams& params,
           const RoundedPlaces& places);

  bool is_made() const { return mesh_.status == PartsStatus::Success; }
  /// All but the handle: the boundary is on rank 0, what is said of the whole on all ranks. \pre is_made()
  MadeInParts summary(ImplicitFunctionRef psi) const;
  /// MeshInParts::write(). \throw KnownToAll
  void write(const std::filesystem::path& file, MeshState state, bool moving_alone);
  /// MeshInParts::write_quality(). \throw KnownToAll
  void write_quality(const std::filesystem::path& file);

 private:
  std::vector<Vec3> chosen() const;
  void gather_boundary(UmResult& result) const;
  void measure_assumptions(UmResult& result) const;

  MPI_Comm comm_;
  const BackgroundMesh background_;
  const RoundedPlaces places_;
  DistributedMesh mesh_;
  bool knows_boundary_ = false;
  std::vector<std::uint8_t> boundary_;  ///< on_boundary(), once it is needed
};

}  // namespace umtet
