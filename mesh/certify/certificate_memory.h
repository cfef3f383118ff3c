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

/// What a certificate measures of one tet.
struct TetValues {
  double quality, volume6, rms_edge;
  double least_cotangent, greatest_cotangent;  ///< signed squares
  bool inverted;
};

/// The mesh certified last, and what was found: of the next one only what differs has to be measured.
///
/// Ids only say where to look: a tet is the same if its four vertices are the same ones of both meshes, to the bit
/// where they were. Faces are counted by indices alone: under a vertex with the same tets in both meshes among those
/// that have faces under it (TwoLeast), and under which no face had one tet only, all have two tets as before, as long
/// as no face had more, or both on one side.
class CertificateMemory {
 public:
  /// Compares with the mesh before. @param vertex_id, tet_id  ascending, else (or of other sizes) nothing is known
  void match(const TetMesh& mesh, const std::vector<std::int64_t>& vertex_id, const std::vector<std::int64_t>& tet_id);
  /// What is known of tet t, or null.
  const TetValues* known(std::size_t t) const {
    return source_.empty() || source_[t] < 0 ? nullptr : &old_[source_[t]];
  }
  void set(std::size_t t, const TetValues& values) { values_[t] = values; }
  /// Per vertex, whether the faces whose least vertex it is have to be counted; null: of all.
  const std::vector<char>* to_count() const { return source_.empty() ? nullptr : &touched_; }
  /// The mesh that was matched takes the place of the one before.
  void remember(const TetMesh& mesh, const std::vector<std::int64_t>& vertex_id,
                const std::vector<std::int64_t>& tet_id, const BoundaryFaces& surface);
  std::size_t n_known() const { return n_known_; }  ///< tets of the last match that were the same

  /// What was found of the mesh before, without walls.
  struct Whole {
    double h;  ///< CertificateInput::h
    MeshCertificate certificate;
    std::vector<int> surface_vertices = {};  ///< ascending; empty until they are needed
  };
  /// That of the mesh before if the one that was matched is the same, bit by bit, or null.
  Whole* of_the_same(double h) { return is_same_ && whole_ && whole_->h == h ? &*whole_ : nullptr; }
  const std::vector<Triangle>& single_faces() const { return single_; }
  void remember(Whole whole) { whole_ = std::move(whole); }
  /// The mesh before stays; in place of remember(), after a match with the same.
  void keep();

 private:
  struct Vertices {
    std::vector<int> now;     ///< index in the new mesh of each old vertex, or -1
    std::vector<char> still;  ///< at the same place, too
  };
  Vertices match_vertices(const TetMesh& mesh, const std::vector<std::int64_t>& vertex_id) const;
  void touch(const Tet& t) {
    const TwoLeast least(t);
    touched_[least.first] = touched_[least.second] = 1;
  }

  TetMesh mesh_;
  std::vector<std::int64_t> vertex_id_, tet_id_;
  std::vector<TetValues> values_, old_;  ///< of the mesh, and of the one before while that is matched
  std::vector<Triangle> single_;         ///< faces of one tet
  bool is_sound_ = false;                ///< no face of more than two tets, or with both on one side
  std::vector<int> source_;              ///< per tet of the matched mesh, the same one before, or -1
  std::vector<char> touched_;            ///< per vertex of the matched mesh
  std::size_t n_known_ = 0;
  bool is_same_ = false;        ///< the matched mesh is the one before
  std::optional<Whole> whole_;  ///< of the mesh before
};

}  // namespace umtet
