#include "distributed/certify/part_boundary.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <span>

#include "common/disjoint_sets.h"
#include "distributed/exchange/collect.h"
#include "mesh/certify/boundary_surface.h"

namespace umtet {
namespace {

/// A face of a tet.
struct FaceUse {
  std::array<std::int64_t, 3> corners;  ///< background ids, ascending
  std::int64_t id;
  int is_odd;  ///< 1 if the orientation of the face is opposite to the ascending order

  friend bool operator<(const FaceUse& a, const FaceUse& b) {
    return a.corners != b.corners ? a.corners < b.corners : a.id < b.id;
  }
};

FaceUse use_of(const DistributedMesh& mesh, std::size_t t, std::size_t k) {
  const Tet& tet = mesh.mesh.C[t];
  std::array<std::int64_t, 3> v{};
  for (std::size_t c = 0; c < 3; ++c) v[c] = mesh.background_vertex[tet[kTetFace[k][c]]];
  std::rotate(v.begin(), std::min_element(v.begin(), v.end()), v.end());
  const bool is_odd = v[1] > v[2];
  if (is_odd) std::swap(v[1], v[2]);
  return {v, 4 * mesh.background_tet[t] + static_cast<std::int64_t>(k), is_odd ? 1 : 0};
}

/// Counts the uses of each face, and adds the faults to `boundary`. @return ids of the faces of a single tet, ascending
std::vector<std::int64_t> count(std::vector<FaceUse> uses, PartBoundary& boundary) {
  std::vector<std::int64_t> single;
  std::sort(uses.begin(), uses.end());
  for (std::size_t i = 0, j = 0; i < uses.size(); i = j) {
    while (j < uses.size() && uses[j].corners == uses[i].corners) ++j;
    if (j - i == 1) single.push_back(uses[i].id);
    if (j - i == 2) boundary.n_same_side += uses[i].is_odd == uses[i + 1].is_odd;
    if (j - i > 2) ++boundary.n_overused;
  }
  std::sort(single.begin(), single.end());
  return single;
}

/// Faces whose least vertex other ranks also have.
class SharedFaces {
 public:
  SharedFaces(MPI_Comm comm, const DistributedMesh& mesh, const std::vector<char>& shared);
  /// Appends the ids of the faces of a single tet. Collective.
  void add_single(PartBoundary& boundary) const;

 private:
  MPI_Comm comm_;
  std::vector<FaceUse> here_;              ///< no other rank has one of the corners, so no other rank has the face
  std::vector<std::vector<FaceUse>> out_;  ///< for each rank, the faces whose least corner it owns
};

SharedFaces::SharedFaces(MPI_Comm comm, const DistributedMesh& mesh, const std::vector<char>& shared) : comm_(comm) {
  int n_ranks = 1;
  MPI_Comm_size(comm, &n_ranks);
  out_.resize(static_cast<std::size_t>(n_ranks));
  for (std::size_t t = 0; t < mesh.mesh.C.size(); ++t) {
    const Tet& tet = mesh.mesh.C[t];
    if (std::none_of(tet.begin(), tet.end(), [&](int v) { return shared[v]; })) continue;
    for (std::size_t k = 0; k < 4; ++k) {
      const std::array<int, 3> v = {tet[kTetFace[k][0]], tet[kTetFace[k][1]], tet[kTetFace[k][2]]};
      const int least = *std::min_element(v.begin(), v.end());
      if (!shared[least]) continue;
      const bool is_shared = std::all_of(v.begin(), v.end(), [&](int c) { return shared[c]; });
      (is_shared ? out_[mesh.owner[least]] : here_).push_back(use_of(mesh, t, k));
    }
  }
}

void SharedFaces::add_single(PartBoundary& boundary) const {
  const std::vector<std::vector<FaceUse>> in = all_to_all(comm_, out_);
  std::vector<FaceUse> all;
  for (const auto& some : in) all.insert(all.end(), some.begin(), some.end());
  const std::vector<std::int64_t> owned = count(std::move(all), boundary);
  std::vector<std::vector<std::int64_t>> answers(in.size());
  for (std::size_t r = 0; r < in.size(); ++r) {
    for (const FaceUse& use : in[r])
      if (std::binary_search(owned.begin(), owned.end(), use.id)) answers[r].push_back(use.id);
  }
  for (const auto& some : all_to_all(comm_, answers)) boundary.id.insert(boundary.id.end(), some.begin(), some.end());
  const std::vector<std::int64_t> here = count(here_, boundary);
  boundary.id.insert(boundary.id.end(), here.begin(), here.end());
}

void sum(MPI_Comm comm, std::initializer_list<std::size_t*> counts) {
  std::vector<std::uint64_t> n;
  for (const std::size_t* c : counts) n.push_back(*c);
  MPI_Allreduce(MPI_IN_PLACE, n.data(), static_cast<int>(n.size()), MPI_UINT64_T, MPI_SUM, comm);
  std::size_t k = 0;
  for (std::size_t* c : counts) *c = n[k++];
}

/// A face at one of its corners, and its other corners in the order around this corner.
struct FanStep {
  std::int64_t corner, from, to;
};

/// Counts of the edges and faces at one vertex.
struct Fan {
  std::int64_t n_edges = 0;                                      ///< number of edges to vertices with greater ids
  std::size_t n_nonmanifold_edges = 0, n_misoriented_edges = 0;  ///< among these
  bool is_one = true;
};

Fan fan_of(std::span<const FanStep> steps) {
  struct Use {
    std::int64_t other;
    int step;
    bool is_outward;  ///< the face has the edge in the direction away from the vertex
  };
  std::vector<Use> uses;
  for (std::size_t k = 0; k < steps.size(); ++k) {
    uses.push_back({steps[k].from, static_cast<int>(k), true});
    uses.push_back({steps[k].to, static_cast<int>(k), false});
  }
  std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) { return a.other < b.other; });
  DisjointSets joined(steps.size());
  Fan fan;
  for (std::size_t i = 0, j = 0; i < uses.size(); i = j) {
    while (j < uses.size() && uses[j].other == uses[i].other) joined.unite(uses[i].step, uses[j++].step);
    if (uses[i].other < steps[0].corner) continue;
    ++fan.n_edges;
    if (j - i != 2) {
      ++fan.n_nonmanifold_edges;
    } else {
      fan.n_misoriented_edges += uses[i].is_outward == uses[i + 1].is_outward;
    }
  }
  for (std::size_t k = 0; k < steps.size(); ++k) fan.is_one &= joined.find(static_cast<int>(k)) == 0;
  return fan;
}

/// Returns the faces at owned vertices, sorted by vertex. Collective.
std::vector<FanStep> fans_of_owned(MPI_Comm comm, const DistributedMesh& mesh, const PartBoundary& boundary) {
  int n_ranks = 1;
  MPI_Comm_size(comm, &n_ranks);
  std::vector<std::vector<FanStep>> out(static_cast<std::size_t>(n_ranks));
  const auto& id = mesh.background_vertex;
  for (const Triangle& f : boundary.triangles) {
    for (int k = 0; k < 3; ++k) out[mesh.owner[f[k]]].push_back({id[f[k]], id[f[(k + 1) % 3]], id[f[(k + 2) % 3]]});
  }
  std::vector<FanStep> all;
  for (const auto& some : all_to_all(comm, out)) all.insert(all.end(), some.begin(), some.end());
  std::sort(all.begin(), all.end(), [](const FanStep& a, const FanStep& b) { return a.corner < b.corner; });
  return all;
}

/// Labels of local faces and of owned vertices. A label is the least vertex of the piece.
struct Labels {
  std::vector<std::int64_t> of_faces, of_owned;
};

Labels labels_of(MPI_Comm comm, const DistributedMesh& mesh, const VertexOwners& owners, const PartBoundary& boundary) {
  DisjointSets pieces(mesh.mesh.V.size());
  for (const Triangle& f : boundary.triangles) {
    pieces.unite(f[0], f[1]);
    pieces.unite(f[0], f[2]);
  }
  // label[v] is valid for the least vertex v of each local piece; local vertices are in the order of their ids.
  std::vector<std::int64_t> label = mesh.background_vertex, owned = owners.ids();
  for (int changes = 1; changes != 0;) {
    owners.ask([&](std::size_t v) { return label[pieces.find(static_cast<int>(v))]; },
               [&](std::size_t k, std::int64_t l) { owned[k] = std::min(owned[k], l); });
    const std::vector<std::int64_t> told = owners.tell(owned);
    changes = 0;
    for (std::size_t v = 0; v < told.size(); ++v) {
      std::int64_t& l = label[pieces.find(static_cast<int>(v))];
      if (told[v] >= l) continue;
      l = told[v];
      changes = 1;
    }
    MPI_Allreduce(MPI_IN_PLACE, &changes, 1, MPI_INT, MPI_MAX, comm);
  }
  Labels labels{{}, std::move(owned)};
  for (const Triangle& f : boundary.triangles) labels.of_faces.push_back(label[pieces.find(f[0])]);
  return labels;
}

/// Joins the parts of pieces that several ranks have, and returns all pieces on all ranks. Collective.
std::vector<BoundaryPiece> joined(MPI_Comm comm, const std::map<std::int64_t, BoundaryPiece>& own) {
  std::vector<BoundaryPiece> parts;
  for (const auto& [label, piece] : own) parts.push_back(piece);
  std::map<std::int64_t, BoundaryPiece> all;
  for (const BoundaryPiece& part : gathered(comm, parts)) {
    const auto [at, is_new] = all.emplace(part.label, part);
    if (is_new) continue;
    BoundaryPiece& piece = at->second;
    piece.n_vertices += part.n_vertices;
    piece.n_edges += part.n_edges;
    piece.n_faces += part.n_faces;
    if (part.first_face >= piece.first_face) continue;
    piece.first_face = part.first_face;
    std::copy_n(part.corner, 3, piece.corner);
  }
  std::vector<BoundaryPiece> list;
  for (const auto& [label, piece] : all) list.push_back(piece);
  broadcast(comm, list);
  return list;
}

BoundaryPiece& piece_at(std::map<std::int64_t, BoundaryPiece>& pieces, std::int64_t label) {
  return pieces.try_emplace(label, BoundaryPiece{label, 0, 0, 0, std::numeric_limits<std::int64_t>::max(), {}})
      .first->second;
}

}  // namespace

std::int64_t face_id(const DistributedMesh& mesh, std::size_t tet, const Triangle& face) {
  const Tet& t = mesh.mesh.C[tet];
  const auto alone =
      std::find_if(t.begin(), t.end(), [&](int v) { return std::find(face.begin(), face.end(), v) == face.end(); });
  return 4 * mesh.background_tet[tet] + (alone - t.begin());
}

PartBoundary boundary_of_parts(MPI_Comm comm, const DistributedMesh& mesh, const VertexOwners& owners) {
  PartBoundary boundary;
  std::vector<char> alone;
  for (const char s : owners.shared()) alone.push_back(s ? 0 : 1);
  {
    const BoundaryFaces inner = boundary_faces(mesh.mesh.C, mesh.mesh.V.size(), &alone);
    for (std::size_t f = 0; f < inner.triangles.size(); ++f)
      boundary.id.push_back(face_id(mesh, static_cast<std::size_t>(inner.tets[f]), inner.triangles[f]));
    boundary.n_overused = inner.n_overused;
    boundary.n_same_side = inner.n_same_side;
  }
  SharedFaces(comm, mesh, owners.shared()).add_single(boundary);
  sum(comm, {&boundary.n_overused, &boundary.n_same_side});
  std::sort(boundary.id.begin(), boundary.id.end());
  const auto& tets = mesh.background_tet;
  for (const std::int64_t id : boundary.id) {
    const Tet& tet = mesh.mesh.C[std::lower_bound(tets.begin(), tets.end(), id / 4) - tets.begin()];
    const auto& f = kTetFace[id % 4];
    boundary.triangles.push_back({tet[f[0]], tet[f[1]], tet[f[2]]});
  }
  return boundary;
}

BoundaryTopology topology_of_parts(MPI_Comm comm, const DistributedMesh& mesh, const VertexOwners& owners,
                                   const PartBoundary& boundary) {
  BoundaryTopology topology;
  const Labels labels = labels_of(comm, mesh, owners, boundary);
  std::map<std::int64_t, BoundaryPiece> own;
  for (std::size_t f = 0; f < boundary.triangles.size(); ++f) {
    BoundaryPiece& piece = piece_at(own, labels.of_faces[f]);
    ++piece.n_faces;
    if (boundary.id[f] >= piece.first_face) continue;
    piece.first_face = boundary.id[f];
    std::copy_n(mesh.mesh.V[boundary.triangles[f][0]].data(), 3, piece.corner);
  }
  topology.is_on_boundary.assign(owners.ids().size(), 0);
  const std::vector<FanStep> steps = fans_of_owned(comm, mesh, boundary);
  for (std::size_t i = 0, j = 0; i < steps.size(); i = j) {
    while (j < steps.size() && steps[j].corner == steps[i].corner) ++j;
    const Fan fan = fan_of(std::span(steps).subspan(i, j - i));
    const std::size_t k = owners.number(steps[i].corner);
    topology.is_on_boundary[k] = 1;
    topology.n_nonmanifold_edges += fan.n_nonmanifold_edges;
    topology.n_misoriented_edges += fan.n_misoriented_edges;
    topology.n_nonmanifold_vertices += !fan.is_one;
    BoundaryPiece& piece = piece_at(own, labels.of_owned[k]);
    ++piece.n_vertices;
    piece.n_edges += fan.n_edges;
  }
  sum(comm, {&topology.n_nonmanifold_edges, &topology.n_misoriented_edges, &topology.n_nonmanifold_vertices});
  topology.pieces = joined(comm, own);
  for (const BoundaryPiece& piece : topology.pieces) {
    const long characteristic = piece.n_vertices + piece.n_faces - piece.n_edges;
    topology.euler_characteristic += characteristic;
    topology.genus += (2 - characteristic) / 2;
  }
  for (const std::int64_t label : labels.of_faces) {
    const auto at = std::lower_bound(topology.pieces.begin(), topology.pieces.end(), label,
                                     [](const BoundaryPiece& p, std::int64_t l) { return p.label < l; });
    topology.piece.push_back(static_cast<int>(at - topology.pieces.begin()));
  }
  return topology;
}

}  // namespace umtet
