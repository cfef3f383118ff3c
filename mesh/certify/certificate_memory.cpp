#include "mesh/certify/certificate_memory.h"

#include <algorithm>
#include <functional>

namespace umtet {
namespace {

bool are_ascending(const std::vector<std::int64_t>& ids) {
  return std::adjacent_find(ids.begin(), ids.end(), std::greater_equal<>()) == ids.end();
}

}  // namespace

CertificateMemory::Vertices CertificateMemory::match_vertices(const TetMesh& mesh,
                                                              const std::vector<std::int64_t>& vertex_id) const {
  Vertices old{std::vector<int>(vertex_id_.size(), -1), std::vector<char>(vertex_id_.size(), 0)};
  for (std::size_t i = 0, j = 0; i < vertex_id_.size() && j < vertex_id.size();) {
    if (vertex_id_[i] == vertex_id[j]) {
      old.now[i] = static_cast<int>(j);
      old.still[i] = mesh_.V[i] == mesh.V[j];
      ++i, ++j;
    } else {
      vertex_id_[i] < vertex_id[j] ? ++i : ++j;
    }
  }
  return old;
}

void CertificateMemory::match(const TetMesh& mesh, const std::vector<std::int64_t>& vertex_id,
                              const std::vector<std::int64_t>& tet_id) {
  source_.clear();
  n_known_ = 0;
  is_same_ = false;
  const bool was_sound = is_sound_;
  is_sound_ = false;  // until this mesh is remembered
  old_.swap(values_);
  values_.resize(mesh.C.size());  // all of them will be set
  const bool is_listed = vertex_id.size() == mesh.V.size() && tet_id.size() == mesh.C.size();
  if (!was_sound || !is_listed || !are_ascending(vertex_id) || !are_ascending(tet_id)) return;
  const Vertices old = match_vertices(mesh, vertex_id);
  source_.assign(mesh.C.size(), -1);
  touched_.assign(mesh.V.size(), 0);
  // Ids ascend in both meshes: the least vertices of a tet of the one are its least in the other.
  const auto leave = [&](const Tet& t) {
    const TwoLeast least(t);
    for (const int v : {least.first, least.second}) {
      if (old.now[v] >= 0) touched_[old.now[v]] = 1;
    }
  };
  std::size_t i = 0, j = 0;
  while (i < tet_id_.size() && j < tet_id.size()) {
    if (tet_id_[i] < tet_id[j]) {
      leave(mesh_.C[i++]);
    } else if (tet_id[j] < tet_id_[i]) {
      touch(mesh.C[j++]);
    } else {
      const Tet &s = mesh_.C[i], &t = mesh.C[j];
      bool stays = true, still = true;
      for (int k = 0; k < 4; ++k) stays &= old.now[s[k]] == t[k], still &= old.still[s[k]] != 0;
      if (!stays) leave(s), touch(t);
      if (stays && still) source_[j] = static_cast<int>(i), ++n_known_;
      ++i, ++j;
    }
  }
  for (; i < tet_id_.size(); ++i) leave(mesh_.C[i]);
  for (; j < tet_id.size(); ++j) touch(mesh.C[j]);
  for (const Triangle& f : single_) {
    const int v = old.now[*std::min_element(f.begin(), f.end())];
    if (v >= 0) touched_[v] = 1;
  }
  is_same_ = n_known_ == mesh.C.size() && n_known_ == tet_id_.size() && vertex_id == vertex_id_;
}

void CertificateMemory::keep() {
  values_ = std::move(old_);
  is_sound_ = true;
}

void CertificateMemory::remember(const TetMesh& mesh, const std::vector<std::int64_t>& vertex_id,
                                 const std::vector<std::int64_t>& tet_id, const BoundaryFaces& surface) {
  mesh_ = mesh;
  vertex_id_ = vertex_id;
  tet_id_ = tet_id;
  single_ = surface.triangles;
  whole_.reset();
  is_sound_ = surface.n_overused == 0 && surface.n_same_side == 0 && vertex_id.size() == mesh.V.size() &&
              tet_id.size() == mesh.C.size() && are_ascending(vertex_id);
}

}  // namespace umtet
