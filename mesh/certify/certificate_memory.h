#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "mesh/certify/boundary_surface.h"
#include "mesh/certify/certificate.h"
#include "mesh/core/tet_mesh.h"
#include "mesh/core/two_least.h"

namespace umtet {

/// The values that a certificate measures for one tet.
struct TetValues {
  double quality, volume6, rms_edge;
  double least_cotangent, greatest_cotangent;  ///< signed squares
  bool inverted;
};

/// The mesh certified last and its measured values, so that only differences have to be measured for the next mesh.
///
/// Ids only say where to look: a tet is unchanged if its four vertices are the same vertices of both meshes, at the
/// same positions to the bit. Faces are counted by indices alone. Consider a vertex that has the same tets in both
/// meshes, among the tets with faces under it (TwoLeast), and under which no face had one tet only. All faces under it
/// then have two tets as before, provided that no face had more, or both on one side.
class CertificateMemory {
 public:
  /// Compares a mesh with the previous one. @param vertex_id, tet_id  ascending; otherwise, or if the sizes differ,
  /// nothing is known
  void match(const TetMesh& mesh, const std::vector<std::int64_t>& vertex_id, const std::vector<std::int64_t>& tet_id);
  /// The known values of tet t, or null.
  const TetValues* known(std::size_t t) const {
    return source_.empty() || source_[t] < 0 ? nullptr : &old_[source_[t]];
  }
  void set(std::size_t t, const TetValues& values) { values_[t] = values; }
  /// Per vertex, whether the faces with this least vertex have to be counted; null: all faces.
  const std::vector<char>* to_count() const { return source_.empty() ? nullptr : &touched_; }
  /// Stores the matched mesh in place of the previous one.
  void remember(const TetMesh& mesh, const std::vector<std::int64_t>& vertex_id,
                const std::vector<std::int64_t>& tet_id, const BoundaryFaces& surface);
  std::size_t n_known() const { return n_known_; }  ///< unchanged tets in the last match

  /// Results for the previous mesh, without walls.
  struct Whole {
    double h;  ///< CertificateInput::h
    MeshCertificate certificate;
    std::vector<int> surface_vertices = {};  ///< ascending; empty until they are needed
  };
  /// The results for the previous mesh if the matched mesh equals it bit by bit, else null.
  Whole* of_the_same(double h) { return is_same_ && whole_ && whole_->h == h ? &*whole_ : nullptr; }
  const std::vector<Triangle>& single_faces() const { return single_; }
  void remember(Whole whole) { whole_ = std::move(whole); }
  /// Keeps the previous mesh; to be called in place of remember() after a match of an equal mesh.
  void keep();

 private:
  struct Vertices {
    std::vector<int> now;     ///< index of each old vertex in the new mesh, or -1
    std::vector<char> still;  ///< the vertex is also at the same position
  };
  Vertices match_vertices(const TetMesh& mesh, const std::vector<std::int64_t>& vertex_id) const;
  void touch(const Tet& t) {
    const TwoLeast least(t);
    touched_[least.first] = touched_[least.second] = 1;
  }

  TetMesh mesh_;
  std::vector<std::int64_t> vertex_id_, tet_id_;
  std::vector<TetValues> values_, old_;  ///< values of the mesh, and of the previous one during a match
  std::vector<Triangle> single_;         ///< faces of one tet
  bool is_sound_ = false;                ///< no face has more than two tets, or both on one side
  std::vector<int> source_;              ///< per tet of the matched mesh, its index in the previous mesh, or -1
  std::vector<char> touched_;            ///< per vertex of the matched mesh
  std::size_t n_known_ = 0;
  bool is_same_ = false;        ///< the matched mesh equals the previous one
  std::optional<Whole> whole_;  ///< results for the previous mesh
};

}  // namespace umtet
