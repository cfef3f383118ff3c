#pragma once

#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "distributed/io/curved_files.h"
#include "distributed/io/part_files.h"
#include "distributed/mesh/distributed_mesh.h"
#include "distributed/second_order/part_second_order.h"
#include "mesh/background/background_mesh.h"
#include "pipeline/meshing/part_mesher.h"

namespace umtet {

/// The local mesh of a rank with positions in model coordinates, for callers that use it in memory.
struct TakenMesh {
  DistributedMesh mesh;
  /// Data of ten-node tets.
  struct Curved {
    PartEdges edges;
    CurvedParts parts;
  };
  std::optional<Curved> curved;
};

/// The local mesh of a rank with the positions that files store, and its collective operations. All functions are
/// collective.
class HeldMesh {
 public:
  /// @param held  see distributed_mesh()
  HeldMesh(MPI_Comm comm, const BackgroundMesh& background, ImplicitFunctionRef psi, const FastParams& params,
           const std::vector<Vec3>& seeds, const RoundedPlaces& places, double held = 0);

  bool is_made() const { return mesh_.status == PartsStatus::Success; }
  /// Returns all members of MadeInParts except `mesh`. The boundary is on rank 0, data of the whole mesh are on all
  /// ranks.
  /// \pre is_made()
  MadeInParts summary(ImplicitFunctionRef psi) const;
  /// Implements MeshInParts::curve(); mid-sides are on rank 0. \pre is_made()
  CurvedInParts curve(ImplicitFunctionRef psi, const ClosestPointParams& params);
  /// Implements MeshInParts::write().
  /// @param data  used on rank 0 only
  /// \throw KnownToAll
  void write(const std::filesystem::path& file, MeshState state, bool moving_alone, const BoundaryData& data);
  /// Implements MeshInParts::write_quality(). \throw KnownToAll
  void write_quality(const std::filesystem::path& file);
  /// Implements MeshInParts::write_pieces().
  /// @param data  used on rank 0 only, but null on all ranks or on none
  /// \throw KnownToAll
  std::vector<std::filesystem::path> write_pieces(const std::filesystem::path& file, PieceFormat format,
                                                  const PieceData* data);
  /// Returns the local mesh, with ten-node tets after curve().
  TakenMesh release() &&;

 private:
  std::vector<Vec3> chosen() const;
  template <class Write>
  auto with_places(std::vector<Vec3>& V, const Write& write);
  /// Ten-node tets.
  struct Curved {
    PartEdges edges;
    CurvedParts parts;
    std::vector<std::size_t> on_boundary;  ///< owned edges on the boundary
    std::vector<std::size_t> n_of_rank;    ///< on rank 0, the number of these edges per rank
  };
  void gather_boundary(UmResult& result) const;
  void gather_mid_sides(std::vector<Vec3>& mid_sides);
  CurvedPiece curved_piece() const;
  MidSideValues mid_side_values(const BoundaryData& data) const;
  void write_curved(const std::filesystem::path& file, const BoundaryData& data);
  void measure_assumptions(UmResult& result) const;

  MPI_Comm comm_;
  const BackgroundMesh background_;
  const RoundedPlaces places_;
  DistributedMesh mesh_;
  std::optional<Curved> curved_;
  bool knows_boundary_ = false;
  std::vector<std::uint8_t> boundary_;  ///< on_boundary(), computed when first needed
};

}  // namespace umtet
