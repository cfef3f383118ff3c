#include "mesh/tiling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "mesh/background_mesh.h"
#include "mesh/tet_quality.h"

namespace umtet {
namespace {

const Box kUnitBox(Vec3::Zero(), Vec3::Ones());

std::array<Vec3, 4> corners(const Tiling& tiling, int t) {
  std::array<Vec3, 4> x;
  for (int k = 0; k < 4; ++k) {
    const auto& [type, offset] = tiling.tets[t][k];
    for (int a = 0; a < 3; ++a) x[k][a] = tiling.points[type][a] + offset[a];
  }
  return x;
}

TEST(A15, FillsTheCell) {
  double volume = 0;
  for (int t = 0; t < 46; ++t) {
    const auto x = corners(a15(), t);
    const double v6 = volume6(x[0], x[1], x[2], x[3]);
    EXPECT_GT(v6, 0) << "tet " << t;
    volume += v6 / 6;
  }
  EXPECT_EQ(a15().points.size(), 8u);
  EXPECT_EQ(a15().tets.size(), 46u);
  EXPECT_NEAR(volume, 1, 1e-14);  // dyadic coordinates: only the divisions by 6 round
}

TEST(A15, EveryDihedralAngleIsAcute) {
  double least = 180, greatest = 0, q_min = 1, q_max = 0;
  for (int t = 0; t < 46; ++t) {
    const auto x = corners(a15(), t);
    const DihedralRange range = dihedral_range(x[0], x[1], x[2], x[3]);
    least = std::min(least, range.min_deg), greatest = std::max(greatest, range.max_deg);
    const double q = mean_ratio(x[0], x[1], x[2], x[3]);
    q_min = std::min(q_min, q), q_max = std::max(q_max, q);
  }
  EXPECT_NEAR(least, 53.1301, 1e-4);
  EXPECT_NEAR(greatest, 78.4630, 1e-4);
  EXPECT_NEAR(q_min, .9449, 1e-4);
  EXPECT_NEAR(q_max, .9912, 1e-4);
}

TEST(A15, MeanEdgeIsTheMeanOverTheEdgesOfACell) {
  const TilingTables t = tables(a15());
  double sum = 0;
  int n = 0;
  for (int type = 0; type < 8; ++type) {
    EXPECT_EQ(t.link[type].size(), type < 2 ? 12u : 14u);  // Frank-Kasper coordination of sites 2a and 6c
    EXPECT_EQ(t.star[type].size(), type < 2 ? 20u : 24u);
    for (const auto& [other, offset] : t.link[type]) {
      Vec3 e;
      for (int a = 0; a < 3; ++a) e[a] = a15().points[other][a] + offset[a] - a15().points[type][a];
      sum += e.norm(), ++n;
    }
  }
  EXPECT_EQ(n, 2 * 54);
  EXPECT_NEAR(a15().mean_edge, sum / n, 1e-14);
}

TEST(Tiling, AMissingTetIsRefused) {
  Tiling broken = a15();
  broken.tets.pop_back();
  EXPECT_THROW(tables(broken), std::invalid_argument);
}

TEST(BackgroundMesh, NeighborsShareTheirFaceAndAgree) {
  const BackgroundMesh mesh(a15(), kUnitBox, .2);
  std::map<std::array<std::int64_t, 3>, int> faces;
  for (std::int64_t t = 0; t < mesh.n_tets(); ++t) {
    const auto tet = mesh.tet(t);
    for (int k = 0; k < 4; ++k) {
      std::array<std::int64_t, 3> face;
      for (int j = 0, m = 0; j < 4; ++j) {
        if (j != k) face[m++] = tet[j];
      }
      std::sort(face.begin(), face.end());
      ++faces[face];
      const std::int64_t other = mesh.neighbor(t, k);
      if (other < 0) continue;
      const auto shared = mesh.tet(other);
      int back = -1;
      for (int j = 0; j < 4; ++j) {
        if (std::find(face.begin(), face.end(), shared[j]) == face.end()) back = j;
      }
      for (const std::int64_t v : face) ASSERT_NE(std::find(shared.begin(), shared.end(), v), shared.end());
      ASSERT_EQ(mesh.neighbor(other, back), t);
    }
  }
  std::size_t rim = 0;
  for (std::int64_t t = 0; t < mesh.n_tets(); ++t) {
    for (int k = 0; k < 4; ++k) rim += mesh.neighbor(t, k) < 0;
  }
  std::size_t single = 0;
  for (const auto& [face, n] : faces) {
    ASSERT_LE(n, 2);
    single += n == 1;
  }
  EXPECT_EQ(single, rim);
}

TEST(BackgroundMesh, StarAndLinkAreWhatTheTetsSay) {
  const BackgroundMesh mesh(a15(), kUnitBox, .3);
  std::vector<std::set<std::int64_t>> star(mesh.n_vertices()), link(mesh.n_vertices());
  for (std::int64_t t = 0; t < mesh.n_tets(); ++t) {
    for (const std::int64_t v : mesh.tet(t)) {
      star[v].insert(t);
      for (const std::int64_t w : mesh.tet(t)) {
        if (w != v) link[v].insert(w);
      }
    }
  }
  for (std::int64_t v = 0; v < mesh.n_vertices(); ++v) {
    std::vector<std::int64_t> s, l;
    mesh.star(v, s);
    mesh.link(v, l);
    ASSERT_EQ(s, std::vector<std::int64_t>(star[v].begin(), star[v].end()));
    ASSERT_EQ(l, std::vector<std::int64_t>(link[v].begin(), link[v].end()));
    ASSERT_EQ(mesh.has_tets(v), !star[v].empty());
    ASSERT_EQ(mesh.on_rim(v), star[v].size() < (v % 8 < 2 ? 20u : 24u));
  }
}

TEST(BackgroundMesh, CoversTheBox) {
  const Box box(Vec3(-1, .5, 3), Vec3(.3, 1.1, 3.9));
  const BackgroundMesh mesh(a15(), box, .21);
  EXPECT_TRUE(mesh.box().contains(box));
  EXPECT_EQ(mesh.tet_near(box.min() - Vec3::Ones()), -1);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int n = 0; n < 2000; ++n) {
    // Every point of the box, corners included, is in a tet: walk to it.
    Vec3 x = box.min() + box.sizes().cwiseProduct(Vec3(unit(random), unit(random), unit(random)));
    if (n < 8) x = box.corner(static_cast<Box::CornerType>(n));
    std::int64_t t = mesh.tet_near(x);
    bool found = false;
    for (int step = 0; step < 100 && t >= 0 && !found; ++step) {
      const auto tet = mesh.tet(t);
      std::array<Vec3, 4> p;
      for (int k = 0; k < 4; ++k) p[k] = mesh.position(tet[k]);
      int worst = -1;
      double least = -1e-12;
      for (int k = 0; k < 4; ++k) {
        std::array<Vec3, 4> q = p;
        q[k] = x;
        const double b = volume6(q[0], q[1], q[2], q[3]) / volume6(p[0], p[1], p[2], p[3]);
        if (b < least) least = b, worst = k;
      }
      found = worst < 0;
      if (!found) t = mesh.neighbor(t, worst);
    }
    ASSERT_TRUE(found) << x.transpose();
  }
}

TEST(BackgroundMesh, RefusesWhatCannotBeBuilt) {
  EXPECT_THROW(BackgroundMesh(a15(), kUnitBox, 0), std::invalid_argument);
  EXPECT_THROW(BackgroundMesh(a15(), kUnitBox, std::nan("")), std::invalid_argument);
  EXPECT_THROW(BackgroundMesh(a15(), Box(), .1), std::invalid_argument);
  EXPECT_THROW(BackgroundMesh(a15(), kUnitBox, 1e-5), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
