#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "distributed/exchange/neighbourhood.h"
#include "mesh/background/background_mesh.h"
#include "mesh/core/implicit_function.h"
#include "mesh/core/tet_mesh.h"
#include "mesh/fast/fast_params.h"
#include "mesh/submesh/um_result.h"

namespace umtet {

/// Success of distributed_mesh(), or the reason of its failure.
enum class PartsStatus {
  Success,
  EmptyDomain,             ///< psi < 0 at no background vertex, or no body is left that h can resolve
  DomainLeavesBackground,  ///< psi < 0 at a vertex on the background boundary
};
const char* to_string(PartsStatus);

/// The local mesh of a rank: its part of a distributed mesh.
struct DistributedMesh {
  PartsStatus status = PartsStatus::Success;  ///< the same on all ranks; there is a mesh only if it is Success
  /// Number of vertices on all ranks at which the reason of a failure applies.
  std::size_t n_places = 0;
  /// Background ids of the local tets, ascending; each tet is on one rank.
  std::vector<std::int64_t> background_tet;
  TetMesh mesh;                                 ///< the local tets, and all their vertices
  std::vector<Vec3> projected;                  ///< UmResult::projected
  std::vector<std::int64_t> background_vertex;  ///< id of each vertex, ascending
  std::vector<ManifoldFlip> manifold_flips;     ///< UmResult::manifold_flips of all ranks
  std::size_t n_chosen_tets = 0;                ///< ChosenSubmesh::n_tets of all ranks
  std::size_t n_stepped_back = 0;               ///< UmResult::n_stepped_back of all ranks
  std::vector<int> owner;                       ///< owning rank of each vertex
  std::vector<Triangle> positive_faces;         ///< Submesh::positive_faces of the local tets
  std::vector<int> positive_tets;               ///< Submesh::positive_tets
  /// Total of all ranks; points near borders between ranks are evaluated more than once.
  std::size_t n_psi_evaluations = 0;
  Traffic traffic;                        ///< communication, except in repair
  std::size_t n_gets = 0, bytes_got = 0;  ///< reads of other ranks by repair; counted on rank 0, which runs it
};

/// Distributed version of fast_mesh(): makes the same mesh of {psi < 0}, byte for byte, for any number of ranks and
/// threads, by chosen inside vertices, projection, smoothing, tangential relaxation, repair, and removal of
/// self-intersections. Each rank stores its own blocks and adjacent blocks. README.md describes the dependencies.
///
/// Collective; all ranks pass the same arguments. psi must be thread-safe.
/// @param background  a lattice over a tiling with costs (configuration_costs.h)
/// @param seeds       if not empty, seeds of SubmeshSearch::Crawl: components of psi = 0 without a seed are not meshed
/// @param held        bytes that rank 0 holds for other purposes, which reduce its share of the mesh; used on rank 0
///                    only
/// \throw std::invalid_argument  for another kind of background; for params, with every broken constraint
DistributedMesh distributed_mesh(MPI_Comm comm, const BackgroundMesh& background, ImplicitFunctionRef psi,
                                 const FastParams& params = {}, const std::vector<Vec3>& seeds = {}, double held = 0);

}  // namespace umtet
