#include "distributed/mesh/part_embedding.h"

#include <algorithm>
#include <array>
#include <set>
#include <unordered_map>

#include "distributed/exchange/collect.h"
#include "distributed/mesh/layer_window.h"
#include "mesh/core/orientation.h"
#include "mesh/embedding/self_intersections.h"
#include "mesh/fast/repair/step_back.h"
#include "mesh/submesh/linked_active_layer.h"

namespace umtet {
namespace {

// Distance in edges around a vertex that steps back within which all data are read: vertices move by at most two edges,
// so all faces that their faces can meet lie in this region.
constexpr int kReach = 16;

struct SentFace {
  std::int64_t corner[3];
  double place[3][3];
};

struct SentPlace {
  std::int64_t vertex;
  double place[3];
};

/// The boundary faces that a rank tests: its own faces, followed by nearby faces of other ranks.
class NearFaces {
 public:
  NearFaces(const LatticePart& part, Neighbourhood& ranks, const PartSurface& surface);
  /// Adds the ids of the corners of intersecting faces, if one of the two is an own face.
  void add_meeting(std::set<std::int64_t>& vertices) const;

 private:
  int number(std::int64_t v, const Vec3& x);

  std::vector<Triangle> faces_;
  std::size_t n_own_ = 0;
  std::vector<Vec3> V_;
  std::vector<std::int64_t> id_;  ///< ids in the whole lattice of the vertices V_
  std::unordered_map<std::int64_t, int> number_;
};

int NearFaces::number(std::int64_t v, const Vec3& x) {
  const auto [at, is_new] = number_.try_emplace(v, static_cast<int>(V_.size()));
  if (is_new) {
    V_.push_back(x);
    id_.push_back(v);
  }
  return at->second;
}

NearFaces::NearFaces(const LatticePart& part, Neighbourhood& ranks, const PartSurface& surface) {
  std::vector<Neighbourhood::Bytes> out(ranks.ranks().size());
  for (const Tet& t : surface.mesh.C) {
    int n_inside = 0, alone = 0;
    for (int k = 0; k < 4; ++k) {
      if (!surface.inside.test(surface.vertex[t[k]])) continue;
      ++n_inside;
      alone = k;
    }
    if (n_inside != 1) continue;
    SentFace face{};
    Triangle own{};
    for (std::size_t k = 0; k < 3; ++k) {
      const int v = t[kTetFace[alone][k]];
      const Vec3& x = surface.mesh.V[v];
      face.corner[k] = part.to_whole(surface.vertex[v]);
      std::copy_n(x.data(), 3, face.place[k]);
      own[k] = number(face.corner[k], x);
    }
    faces_.push_back(own);
    // A rank with a face that can meet this one has a block next to the block of this corner.
    for (const int rank : part.knowers(surface.vertex[t[kTetFace[alone][0]]])) put(out[ranks.number(rank)], face);
  }
  n_own_ = faces_.size();
  for (const Neighbourhood::Bytes& message : ranks.exchange(out)) {
    for (std::size_t at = 0; at < message.size();) {
      const auto face = take<SentFace>(message, at);
      Triangle other{};
      for (std::size_t k = 0; k < 3; ++k)
        other[k] = number(face.corner[k], Vec3(face.place[k][0], face.place[k][1], face.place[k][2]));
      faces_.push_back(other);
    }
  }
}

void NearFaces::add_meeting(std::set<std::int64_t>& vertices) const {
  for (const auto& pair : self_intersections(V_, faces_)) {
    if (static_cast<std::size_t>(std::min(pair[0], pair[1])) >= n_own_) continue;
    for (const int f : pair) {
      for (const int v : faces_[f]) vertices.insert(id_[v]);
    }
  }
}

/// Returns the corners of own tets that are not positive, and of intersecting faces.
std::vector<std::int64_t> places_to_mend(const LatticePart& part, Neighbourhood& ranks, const PartSurface& surface) {
  std::set<std::int64_t> vertices;
  NearFaces(part, ranks, surface).add_meeting(vertices);
  const std::vector<Vec3>& V = surface.mesh.V;
  for (const Tet& t : surface.mesh.C) {
    if (orientation_sign(V[t[0]], V[t[1]], V[t[2]], V[t[3]]) > 0) continue;
    for (const int v : t) vertices.insert(part.to_whole(surface.vertex[v]));
  }
  return {vertices.begin(), vertices.end()};
}

/// Applies step_back() to the mesh in the region around these vertices. If a vertex near the rim of the region moves, a
/// larger region is read.
std::vector<SentPlace> mended(const BackgroundMesh& whole, LayerWindow& window, std::vector<std::int64_t> around) {
  BlocksAround blocks(whole, window, kReach);
  IdSet inside(whole.n_vertices());
  std::unordered_map<std::int64_t, Vec3> places;
  for (;;) {
    for (const std::int64_t v : around) {
      for (const LayerVertex& w : blocks(v)) {
        if (w.is_inside) inside.insert(w.vertex);
        places[w.vertex] = w.place;
      }
    }
    const Submesh submesh = emit_submesh(whole, inside);
    std::vector<Vec3> V = submesh.mesh.V;
    for (std::size_t v = 0; v < V.size(); ++v) {
      if (const auto at = places.find(submesh.background_vertex[v]); at != places.end()) V[v] = at->second;
    }
    const StepBackReport report = step_back(
        submesh, {}, [&](int) { return whole.h(); }, V);
    std::vector<SentPlace> moved;
    around.clear();
    for (const int v : report.vertices) {
      around.push_back(submesh.background_vertex[v]);
      moved.push_back({around.back(), {V[v][0], V[v][1], V[v][2]}});
    }
    if (std::all_of(around.begin(), around.end(), [&](std::int64_t v) { return blocks.has_given(v); })) return moved;
  }
}

}  // namespace

std::vector<std::pair<std::int64_t, Vec3>> step_parts_back(MPI_Comm comm, const LatticePart& part,
                                                           const Partition& partition, Neighbourhood& ranks,
                                                           const PartSurface& surface) {
  std::vector<std::int64_t> around = gathered(comm, places_to_mend(part, ranks, surface));
  broadcast(comm, around);
  if (around.empty()) return {};
  std::vector<SentPlace> moved;
  {
    LayerWindow window(comm, part, partition, surface.inside, surface.places);
    if (rank_in(comm) == 0) moved = mended(part.whole(), window, std::move(around));
    MPI_Barrier(comm);  // the window is open until rank 0 has done
  }
  broadcast(comm, moved);
  std::vector<std::pair<std::int64_t, Vec3>> made;
  for (const SentPlace& m : moved) made.emplace_back(m.vertex, Vec3(m.place[0], m.place[1], m.place[2]));
  return made;
}

}  // namespace umtet
