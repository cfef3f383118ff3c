#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "mesh/certify/certificate.h"
#include "mesh/universal_mesh.h"

namespace umtet {

/// Which unknowns of a P1 discretisation meet, over the whole background: rows of all matrices of the family.
struct SparsityPattern {
  std::vector<std::int64_t> row_begin;  ///< per background vertex, and one more
  std::vector<std::int64_t> column;     ///< vertices that share an edge with it, ascending; not itself
};
/// Cost: 8 bytes a neighbour, fourteen of them for A15.
SparsityPattern sparsity_pattern(const BackgroundMesh& background);

/// Where the boundary may be that was not there before; all optional.
struct UpdateHints {
  std::vector<Vec3> seeds;  ///< a point near each new component, such as a body that enters
  /// True only if psi has no zero in the box. With it no new component is missed: psi is evaluated at every background
  /// vertex that lies in a cell for which this does not hold; of a background without cells, every vertex.
  std::function<bool(const Box&)> no_zero_in;
};

/// The mesh at one time, and what is new about it: nothing, if psi has the signs it had at all vertices and vanishes at
/// those of the boundary. Ids are those of the background, ascending; after an update that did not succeed the next one
/// compares with the last that did.
struct UmUpdate {
  UmResult mesh;
  std::vector<std::int64_t> vertices_entered, vertices_left, tets_entered, tets_left;
  std::vector<std::int64_t> vertices_moved;  ///< in both meshes, at different places
  std::size_t n_searched = 0;                ///< values of psi to classify vertices; the first time, of all vertices
  std::size_t n_recalled = 0;                ///< vertices that began where the last mesh had them
};

/// Meshes of a domain that moves, in one background mesh, each from the one before         [Rangarajan2018, Section 4]
///
/// A vertex changes sides only if psi = 0 passes over it: the search walks from the last boundary as far as vertices do
/// change, whatever the size of the background. Vertices stay inside or outside where that costs as little as a change,
/// and begin where they were, or are drawn along by the boundary (warm_start.h), instead of in the background. Then
/// smoothing and repair are those of fast_mesh(), so that a mesh is as good as one made anew (1 % quantile and mean of
/// Q within .01; the least is above the same target), but not the same to the bit: it depends on the meshes before it.
/// The same bytes for any number of threads.
///
/// A new component, or a cavity, away from the last boundary is not met by the walk: see UpdateHints.
/// Cost: some words a hundred background vertices (bit sets), else as the surface and the tets that are returned.
class UniversalMesh {
 public:
  /// @param params  UmMode::Fast. seeds and search are not used: the first update, and one after a domain
  ///                that was empty, evaluates psi at every vertex
  /// \throw std::invalid_argument naming every broken constraint; UmMode::Paper
  explicit UniversalMesh(BackgroundMesh background, const UmParams& params = {});
  ~UniversalMesh();
  UniversalMesh(UniversalMesh&&) noexcept;
  UniversalMesh& operator=(UniversalMesh&&) noexcept;

  const BackgroundMesh& background() const;
  /// Foreseen failures are statuses with evidence, as those of universal_mesh(); the next update then starts from the
  /// background's places, and is compared with the last mesh there is. Where psi or the context throws, or it is
  /// cancelled, the last mesh is what the next update starts from and is compared with; what an earlier call returned
  /// may be empty. Reports the steps "search" and those of fit_submesh(). \throw Cancelled
  /// @return what the next call of update() overwrites: to be copied where it is wanted longer
  const UmUpdate& update(ImplicitFunctionRef psi, const UpdateHints& hints = {}, const Context& context = {});
  /// The certificate of a mesh of update(), field by field that of certify() with its positive faces, walls and psi;
  /// of the tets only those that have changed since the last call are measured.
  /// \throw std::invalid_argument without tets; Cancelled
  MeshCertificate certify(const UmResult& mesh, ImplicitFunctionRef psi, const Context& context = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace umtet
