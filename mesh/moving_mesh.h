#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "mesh/certify/certificate.h"
#include "mesh/universal_mesh.h"

namespace umtet {

/// Sparsity pattern of a P1 discretisation on the whole background mesh. It holds the rows of all matrices of the
/// family of meshes.
struct SparsityPattern {
  std::vector<std::int64_t> row_begin;  ///< offsets into column: one entry per background vertex, and one more
  std::vector<std::int64_t> column;     ///< neighbours along edges, ascending, without the row's vertex
};
/// The sparsity pattern of a background mesh.
/// Cost: 8 bytes per neighbour; A15 has fourteen neighbours per vertex.
SparsityPattern sparsity_pattern(const BackgroundMesh& background);

/// Hints to UniversalMesh::update() where new parts of the boundary may be; all are optional.
struct UpdateHints {
  std::vector<Vec3> seeds;  ///< a point near each new component, such as a body that enters
  /// Returns true only if psi has no zero in the box. With this function no new component is missed: psi is evaluated
  /// at every background vertex in a cell for which the function returns false. In a background without cells it is
  /// evaluated at every vertex.
  std::function<bool(const Box&)> no_zero_in;
};

/// The mesh at one time, and its changes since the last mesh.
///
/// There are no changes if psi has the same signs at all vertices and vanishes at the vertices of the boundary. Ids are
/// ids of the background, ascending. After an update that failed, the next update compares with the last successful
/// one.
struct UmUpdate {
  UmResult mesh;
  std::vector<std::int64_t> vertices_entered, vertices_left, tets_entered, tets_left;
  std::vector<std::int64_t> vertices_moved;  ///< vertices of both meshes whose position changed
  std::size_t n_searched = 0;  ///< evaluations of psi to classify vertices; the first time, at all vertices
  std::size_t n_recalled = 0;  ///< vertices that began at their position in the last mesh
};

/// Meshes of a moving domain in one background mesh, each made from the previous one        [Rangarajan2018, Section 4]
///
/// A vertex changes sides only if psi = 0 passes over it. The search therefore walks from the last boundary and stops
/// where vertices no longer change; its cost does not depend on the size of the background. Vertices stay inside or
/// outside where this costs as little as a change. They begin at their last position, or are drawn along by the
/// boundary (warm_start.h), instead of at their background position. Smoothing and repair work as in fast_mesh(). A
/// mesh is therefore as good as one made from scratch (1 % quantile and mean of Q within .01; the least Q is above the
/// same target), but not the same to the bit, because it depends on the meshes before it. The bytes are the same for
/// any number of threads.
///
/// The walk does not meet a new component, or a new cavity, away from the last boundary: see UpdateHints.
/// Memory: a few words per hundred background vertices (bit sets). Other costs grow with the surface and with the
/// number of tets returned.
class UniversalMesh {
 public:
  /// @param params  UmMode::Fast. `seeds` and `search` are not used: the first update, and any update after an empty
  ///                domain, evaluates psi at every vertex
  /// \throw std::invalid_argument naming every broken constraint, or for UmMode::Paper
  explicit UniversalMesh(BackgroundMesh background, const UmParams& params = {});
  ~UniversalMesh();
  UniversalMesh(UniversalMesh&&) noexcept;
  UniversalMesh& operator=(UniversalMesh&&) noexcept;

  const BackgroundMesh& background() const;
  /// Makes the mesh of a new psi. Reports the step "search" and the steps of fit_submesh().
  ///
  /// - Foreseen failures are statuses with evidence, as in universal_mesh(). The next update then starts from the
  ///   background positions, and is compared with the last mesh that exists.
  /// - If psi or the context throws, or the call is cancelled, the next update starts from the last mesh and is
  ///   compared with it. The result of an earlier call may then be empty.
  ///
  /// \throw Cancelled
  /// @return a reference that the next call of update() overwrites; copy the value to keep it
  const UmUpdate& update(ImplicitFunctionRef psi, const UpdateHints& hints = {}, const Context& context = {});
  /// The certificate of a mesh made by update(). It equals, field by field, the result of umtet::certify() with the
  /// mesh's positive faces, walls and psi. Only the tets that have changed since the last call are measured.
  /// \throw std::invalid_argument if the mesh has no tets; Cancelled
  MeshCertificate certify(const UmResult& mesh, ImplicitFunctionRef psi, const Context& context = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace umtet
