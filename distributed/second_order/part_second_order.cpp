#include "distributed/second_order/part_second_order.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "distributed/exchange/collect.h"
#include "distributed/second_order/mid_side_patch.h"
#include "mesh/second_order/mid_side_projection.h"

namespace umtet {
namespace {

class Curving {
 public:
  Curving(MPI_Comm comm, const DistributedMesh& mesh, const PartEdges& edges, ImplicitFunctionRef psi, double h,
          const SecondOrderParams& params)
      : comm_(comm),
        mesh_(mesh),
        edges_(edges),
        psi_(psi),
        h_(h),
        params_(params),
        n_corners_(mesh.mesh.V.size()),
        kind_(edges.ends().size(), MidSide::Free) {}

  CurvedParts operator()();

 private:
  void find_curved();
  void project();
  std::size_t n_fixed() const;
  void relax(const std::vector<int>& below);
  SentTet sent(std::size_t tet) const;
  std::vector<SentTet> not_sent_at(const std::vector<PartEdges::Ids>& edges);
  void put(const std::vector<MovedMidSide>& moved);
  int own_edge(const PartEdges::Ids& edge) const;

  MPI_Comm comm_;
  const DistributedMesh& mesh_;
  const PartEdges& edges_;
  ImplicitFunctionRef psi_;
  const double h_;
  const SecondOrderParams& params_;
  const std::size_t n_corners_;
  std::vector<MidSide> kind_;  ///< kind of each edge of the local mesh
  std::vector<char> is_sent_;  ///< for each local tet, whether rank 0 has received it
  CurvedParts made_;
};

void Curving::find_curved() {
  std::vector<char> own(edges_.ends().size(), 0);
  for (const Triangle& f : mesh_.positive_faces) {
    for (int k = 0; k < 3; ++k) own[edges_.number()(f[k], f[(k + 1) % 3])] = 1;
  }
  made_.is_curved = edges_.exchange().any(own);
}

void Curving::project() {
  std::vector<CurvedEdge> curved;
  for (std::size_t e = 0; e < kind_.size(); ++e) {
    if (made_.is_curved[e])
      curved.push_back({static_cast<int>(n_corners_ + e), edges_.ends()[e][0], edges_.ends()[e][1]});
  }
  project_mid_sides(curved, psi_, h_, params_.closest_point, made_.mesh.V, kind_);
}

/// Returns the number of fixed mid-sides on all ranks. Collective.
std::size_t Curving::n_fixed() const {
  std::vector<char> own(kind_.size());
  for (std::size_t e = 0; e < own.size(); ++e) own[e] = kind_[e] == MidSide::Fixed;
  const std::vector<char> is_fixed = edges_.exchange().any_of_owned(own);
  return sum(comm_, static_cast<std::size_t>(std::count(is_fixed.begin(), is_fixed.end(), 1)));
}

SentTet Curving::sent(std::size_t tet) const {
  SentTet made{};
  made.id = mesh_.background_tet[tet];
  const QuadraticTet& nodes = made_.mesh.C[tet];
  for (std::size_t k = 0; k < 10; ++k) {
    std::copy_n(made_.mesh.V[nodes[k]].data(), 3, made.place[k]);
    if (k < 4) made.corner[k] = mesh_.background_vertex[nodes[k]];
    if (k >= 4) made.kind[k - 4] = static_cast<std::int64_t>(kind_[static_cast<std::size_t>(nodes[k]) - n_corners_]);
  }
  return made;
}

/// Returns the local number of an edge; -1 if it is not in the local mesh.
int Curving::own_edge(const PartEdges::Ids& edge) const {
  std::array<int, 2> ends{};
  const std::vector<std::int64_t>& ids = mesh_.background_vertex;
  for (std::size_t k = 0; k < 2; ++k) {
    const auto at = std::lower_bound(ids.begin(), ids.end(), edge[k]);
    if (at == ids.end() || *at != edge[k]) return -1;
    ends[k] = static_cast<int>(at - ids.begin());
  }
  return edges_.number()(ends[0], ends[1]);
}

/// Returns the local tets with one of these edges that rank 0 has not received.
std::vector<SentTet> Curving::not_sent_at(const std::vector<PartEdges::Ids>& edges) {
  std::vector<char> is_asked(kind_.size(), 0);
  bool any = false;
  for (const PartEdges::Ids& edge : edges) {
    const int e = own_edge(edge);
    if (e >= 0) is_asked[static_cast<std::size_t>(e)] = any = true;
  }
  std::vector<SentTet> tets;
  for (std::size_t t = 0; any && t < made_.mesh.C.size(); ++t) {
    const QuadraticTet& nodes = made_.mesh.C[t];
    const bool has_one = std::any_of(nodes.begin() + 4, nodes.end(),
                                     [&](int node) { return is_asked[static_cast<std::size_t>(node) - n_corners_]; });
    if (!has_one || is_sent_[t]) continue;
    is_sent_[t] = 1;
    tets.push_back(sent(t));
  }
  return tets;
}

void Curving::put(const std::vector<MovedMidSide>& moved) {
  for (const MovedMidSide& m : moved) {
    const int e = own_edge(m.edge);
    if (e < 0) continue;
    made_.mesh.V[n_corners_ + static_cast<std::size_t>(e)] = Vec3(m.place);
    kind_[static_cast<std::size_t>(e)] = static_cast<MidSide>(m.kind);
  }
}

void Curving::relax(const std::vector<int>& below) {
  is_sent_.assign(made_.mesh.C.size(), 0);
  std::vector<SentTet> first;
  for (const int t : below) {
    first.push_back(sent(static_cast<std::size_t>(t)));
    is_sent_[t] = 1;
  }
  MidSidePatch patch;
  patch.add_ring(gathered(comm_, first));
  MidSidePatch::Relaxed relaxed;
  // Mid-sides of a tet that becomes bad also move, so each sweep can reach one more ring of tets; this is rare. If
  // relaxation reaches the rim of the patch, it is repeated with twice the number of rings.
  int needs_more = 1;
  for (int n_rings = 1; needs_more; n_rings *= 2) {
    for (int ring = 0; ring < n_rings; ++ring) {
      std::vector<PartEdges::Ids> edges = patch.edges();
      broadcast(comm_, edges);
      patch.add_ring(gathered(comm_, not_sent_at(edges)));
    }
    if (rank_in(comm_) == 0) relaxed = patch.relaxed(psi_, h_, params_);
    needs_more = relaxed.has_met_rim ? 1 : 0;
    MPI_Bcast(&needs_more, 1, MPI_INT, 0, comm_);
  }
  broadcast(comm_, relaxed.moved);
  put(relaxed.moved);
  made_.n_slid = sum(comm_, relaxed.n_slid);
  made_.n_relaxed = sum(comm_, relaxed.n_relaxed);
}

CurvedParts Curving::operator()() {
  made_.mesh = edges_.number().straight_mesh(mesh_.mesh);
  find_curved();
  project();
  made_.n_unprojected = n_fixed();
  const std::vector<int> below = tets_below(made_.mesh, kind_, params_.target);
  if (sum(comm_, below.size()) > 0) relax(below);
  made_.n_off_surface = n_fixed();
  return std::move(made_);
}

}  // namespace

CurvedParts curved_parts(MPI_Comm comm, const DistributedMesh& mesh, const PartEdges& edges, ImplicitFunctionRef psi,
                         double h, const SecondOrderParams& params) {
  return Curving(comm, mesh, edges, psi, h, params)();
}

}  // namespace umtet
