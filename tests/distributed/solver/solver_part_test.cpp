#include "distributed/solver/solver_part.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "distributed/exchange/collect.h"
#include "distributed/solver/ghost_tets.h"
#include "mesh/io/solver_mesh.h"
#include "mesh/patches/patches.h"
#include "mesh/universal_mesh.h"
#include "tests/distributed/ranks.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

using testing::AnalyticDomain;
using testing::n_ranks;
using testing::rank;

/// Two balls of equal size far apart, so that ranks may have one of them, or none.
AnalyticDomain two_balls() {
  AnalyticDomain domain = testing::sphere();
  domain.name = "two balls";
  domain.box = Box(Vec3(-1.1, -1.1, -1.1), Vec3(4.1, 1.1, 1.1));
  domain.psi = [](const Vec3& x, Vec3* g, Mat3* H) {
    const Vec3 y = x.x() > 1.5 ? Vec3(x - Vec3(3, 0, 0)) : x;
    if (g) *g = 2 * y;
    if (H) *H = 2 * Mat3::Identity();
    return y.squaredNorm() - 1;
  };
  return domain;
}

struct Made {
  UmResult one;  ///< of one process
  DistributedMesh mesh;
  SolverPart part;
};

Made made(const AnalyticDomain& domain, double h) {
  const Vec3 more = Vec3::Constant(3 * h);
  const BackgroundMesh background(a15(), Box(domain.box.min() - more, domain.box.max() + more), h);
  Made m{universal_mesh(background, domain, {}), distributed_mesh(MPI_COMM_WORLD, background, domain), {}};
  m.part = solver_part(MPI_COMM_WORLD, m.mesh);
  return m;
}

const std::vector<AnalyticDomain>& domains() {
  static const std::vector<AnalyticDomain> list = {testing::torus(), two_balls()};
  return list;
}

TEST(SolverPart, NumbersAreThoseOfOneProcess) {
  for (const AnalyticDomain& domain : domains()) {
    SCOPED_TRACE(domain.name);
    const Made m = made(domain, .15);
    EXPECT_EQ(m.part.n_vertices, m.one.final.size());
    EXPECT_EQ(m.part.n_tets, m.one.submesh.mesh.C.size());
    EXPECT_EQ(m.part.n_faces, m.one.submesh.positive_faces.size());
    for (std::size_t v = 0; v < m.mesh.mesh.V.size(); ++v)
      ASSERT_EQ(m.mesh.mesh.V[v], m.one.final[static_cast<std::size_t>(m.part.global_vertex[v])]);
    for (std::size_t t = 0; t < m.mesh.mesh.C.size(); ++t) {
      for (std::size_t k = 0; k < 4; ++k)
        ASSERT_EQ(m.part.global_vertex[m.mesh.mesh.C[t][k]],
                  m.one.submesh.mesh.C[static_cast<std::size_t>(m.part.global_tet[t])][k]);
    }
  }
}

TEST(SolverPart, EachVertexIsOwnedByTheFirstWhoHasItAndCountedByRank) {
  struct Held {
    std::int64_t vertex, solver_vertex;
    int rank, owner;
  };
  for (const AnalyticDomain& domain : domains()) {
    SCOPED_TRACE(domain.name);
    const Made m = made(domain, .15);
    std::vector<Held> held;
    for (std::size_t v = 0; v < m.part.owner.size(); ++v)
      held.push_back({m.part.global_vertex[v], m.part.solver_vertex[v], rank(), m.part.owner[v]});
    held = gathered(MPI_COMM_WORLD, held);
    if (rank() != 0) continue;
    std::map<std::int64_t, Held> first;
    for (const Held& h : held) {
      const Held& f = first.emplace(h.vertex, h).first->second;  // of the least rank
      EXPECT_EQ(h.owner, f.rank);
      EXPECT_EQ(h.solver_vertex, f.solver_vertex);
    }
    std::vector<Held> owned;
    for (const auto& [vertex, h] : first) owned.push_back(h);
    std::sort(owned.begin(), owned.end(),
              [](const Held& a, const Held& b) { return std::pair(a.rank, a.vertex) < std::pair(b.rank, b.vertex); });
    for (std::size_t k = 0; k < owned.size(); ++k) EXPECT_EQ(owned[k].solver_vertex, static_cast<std::int64_t>(k));
  }
}

TEST(SolverPart, SharersAreAllOthersWithATetThere) {
  struct Held {
    std::int64_t vertex;
    int rank;
    auto operator<=>(const Held&) const = default;
  };
  for (const AnalyticDomain& domain : domains()) {
    SCOPED_TRACE(domain.name);
    const Made m = made(domain, .15);
    std::vector<Held> held;
    for (const std::int64_t v : m.part.global_vertex) held.push_back({v, rank()});
    held = gathered(MPI_COMM_WORLD, held);
    broadcast(MPI_COMM_WORLD, held);
    const std::set<std::int64_t> own(m.part.global_vertex.begin(), m.part.global_vertex.end());
    std::set<Held> expected, found;
    for (const Held& h : held)
      if (h.rank != rank() && own.contains(h.vertex)) expected.insert(h);
    const Sharers& s = m.part.sharers;
    for (std::size_t k = 0; k < s.vertex.size(); ++k) {
      for (std::size_t i = s.begin[k]; i < s.begin[k + 1]; ++i)
        EXPECT_TRUE(found.insert({m.part.global_vertex[s.vertex[k]], s.rank[i]}).second);
    }
    EXPECT_EQ(found, expected);
  }
}

TEST(SolverPart, PatchesAreThoseOfAnExport) {
  struct Face {
    std::int64_t number, tet;
    int patch;
  };
  for (const AnalyticDomain& domain : domains()) {
    SCOPED_TRACE(domain.name);
    const Made m = made(domain, .15);
    std::vector<Face> faces;
    for (std::size_t f = 0; f < m.part.boundary.size(); ++f) {
      const Triangle& c = m.part.boundary[f];
      std::int64_t tet = -1;
      for (std::size_t t = 0; t < m.mesh.mesh.C.size(); ++t) {
        const Tet& corners = m.mesh.mesh.C[t];
        const auto has = [&](int v) { return std::find(corners.begin(), corners.end(), v) != corners.end(); };
        if (has(c[0]) && has(c[1]) && has(c[2])) tet = m.part.global_tet[t];
      }
      faces.push_back({m.part.global_face[f], tet, m.part.patch[f]});
    }
    faces = gathered(MPI_COMM_WORLD, faces);
    if (rank() != 0) continue;
    const SolverMesh whole = solver_mesh(TetMesh{m.one.final, m.one.submesh.mesh.C});
    const std::vector<int> pieces = smooth_pieces(whole.nodes, whole.triangles(), 180);
    std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) { return a.number < b.number; });
    ASSERT_EQ(faces.size(), whole.n_faces());
    for (std::size_t f = 0; f < faces.size(); ++f) {
      EXPECT_EQ(faces[f].tet, whole.face_tet[f]);
      EXPECT_EQ(faces[f].patch, pieces[f]);
    }
    const auto n = static_cast<std::size_t>(*std::max_element(pieces.begin(), pieces.end())) + 1;
    EXPECT_EQ(m.part.patches.size(), n);
    EXPECT_EQ(m.part.patches.front(), n == 1 ? "boundary" : "boundary_1");
  }
}

TEST(SolverPart, BoundaryVerticesAreThoseOfTheWholeMesh) {
  const Made m = made(testing::torus(), .15);
  const std::set<int> on(m.one.submesh.positive_vertices.begin(), m.one.submesh.positive_vertices.end());
  std::vector<int> expected;
  for (std::size_t v = 0; v < m.part.global_vertex.size(); ++v)
    if (on.contains(static_cast<int>(m.part.global_vertex[v]))) expected.push_back(static_cast<int>(v));
  EXPECT_EQ(m.part.boundary_vertices, expected);
}

TEST(GhostTets, AreThoseOfOthersThatTouchOwnVertices) {
  for (const AnalyticDomain& domain : domains()) {
    SCOPED_TRACE(domain.name);
    const Made m = made(domain, .2);
    const std::set<std::int64_t> vertices(m.part.global_vertex.begin(), m.part.global_vertex.end()),
        tets(m.part.global_tet.begin(), m.part.global_tet.end());
    std::vector<std::int64_t> expected;
    for (std::size_t t = 0; t < m.one.submesh.mesh.C.size(); ++t) {
      const Tet& c = m.one.submesh.mesh.C[t];
      const bool touches = std::any_of(c.begin(), c.end(), [&](int v) { return vertices.contains(v); });
      if (touches && !tets.contains(static_cast<std::int64_t>(t))) expected.push_back(static_cast<std::int64_t>(t));
    }
    std::vector<std::int64_t> found;
    for (const GhostTet& ghost : ghost_tets(MPI_COMM_WORLD, m.mesh, m.part)) {
      found.push_back(ghost.tet);
      EXPECT_NE(ghost.rank, rank());
      for (std::size_t k = 0; k < 4; ++k) {
        EXPECT_EQ(ghost.corner[k], m.one.submesh.mesh.C[static_cast<std::size_t>(ghost.tet)][k]);
        EXPECT_EQ(Vec3(ghost.place[k][0], ghost.place[k][1], ghost.place[k][2]),
                  m.one.final[static_cast<std::size_t>(ghost.corner[k])]);
      }
    }
    EXPECT_EQ(found, expected);
    if (n_ranks() == 1) {
      EXPECT_TRUE(found.empty());
    }
  }
}

}  // namespace
}  // namespace umtet
