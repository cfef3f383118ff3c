#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "distributed/neighbourhood.h"
#include "mesh/background/background_mesh.h"
#include "mesh/core/implicit_function.h"
#include "mesh/core/tet_mesh.h"
#include "mesh/fast/fast_params.h"
#include "mesh/submesh/um_result.h"

namespace umtet {

enum class PartsStatus {
  Success,
  EmptyDomain,             ///< psi < 0 at no background vertex, or no body is left that h can show
  DomainLeavesBackground,  ///< psi < 0 at a vertex on the background boundary
};
const char* to_string(PartsStatus);

/// What a rank has of a mesh.
struct DistributedMesh {
  PartsStatus status = PartsStatus::Success;    ///< the same on all ranks; without success there is no mesh
  std::size_t n_places = 0;                     ///< vertices that break the rule, of all ranks
  std::vector<std::int64_t> background_tet;     ///< ids in the background, ascending; each tet is on one rank
  TetMesh mesh;                                 ///< its tets, and all their vertices
  std::vector<Vec3> projected;                  ///< UmResult::projected
  std::vector<std::int64_t> background_vertex;  ///< of each vertex, ascending
  std::vector<ManifoldFlip> manifold_flips;     ///< UmResult::manifold_flips, of all ranks
  std::size_t n_chosen_tets = 0;                ///< ChosenSubmesh::n_tets, of all ranks
  std::size_t n_stepped_back = 0;               ///< UmResult::n_stepped_back, of all ranks
  std::vector<int> owner;                       ///< of each vertex, a rank
  std::vector<Triangle> positive_faces;         ///< Submesh::positive_faces of its tets
  std::vector<int> positive_tets;               ///< Submesh::positive_tets
  std::size_t n_psi_evaluations = 0;            ///< of all ranks, which look at what is between them more than once
  Traffic traffic;                              ///< but for repair
  std::size_t n_gets = 0, bytes_got = 0;        ///< what repair has read of other ranks; of rank 0, which does it
};

/// The mesh that fast_mesh() makes of {psi < 0}, byte for byte and for any number of ranks and threads: chosen inside
/// vertices, projection, smoothing, tangential relaxation, repair, and no face through another. Each rank holds the
/// blocks that it has and those next to them. README.md says what depends on what.
///
/// Collective; all ranks pass the same arguments. psi must be thread-safe.
/// @param background  a lattice over a tiling that has costs (configuration_costs.h)
/// @param seeds       where there are any, of SubmeshSearch::Crawl: pieces of psi = 0 without one are not meshed
/// @param held        bytes that rank 0 holds besides, which has so much less of the mesh; read there
/// \throw std::invalid_argument for another background, or naming every broken constraint of params
DistributedMesh distributed_mesh(MPI_Comm comm, const BackgroundMesh& background, ImplicitFunctionRef psi,
                                 const FastParams& params = {}, const std::vector<Vec3>& seeds = {}, double held = 0);

}  // namespace umtet
