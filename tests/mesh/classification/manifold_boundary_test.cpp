#include "mesh/classification/manifold_boundary.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <string>

#include "mesh/background/a15_box.h"
#include "mesh/certify/boundary_surface.h"
#include "mesh/classification/configuration_costs.h"
#include "mesh/submesh/assemble_submesh.h"
#include "mesh/submesh/linked_active_layer.h"
#include "mesh/universal_mesh.h"
#include "tests/support/box_tets.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

using Labels = std::function<bool(std::int64_t v, const Vec3& x, std::mt19937& random)>;

/// A background, and whether its boundary is a wall.
struct Place {
  std::string name;
  BackgroundMesh background;
  std::shared_ptr<const VertexLinks> links;  ///< null: those of the stars
  bool has_walls = false;
};

const Box kBox(Vec3::Constant(-1), Vec3::Constant(1));

std::vector<Place> places() {
  std::vector<Place> list;
  for (const std::string_view name : tiling_names()) {
    const Tiling& tiling = tiling_named(name);
    BackgroundMesh background(tiling, kBox, name == "a15" ? .75 : .9);
    auto links = std::make_shared<const VertexLinks>(background, configuration_costs(tiling)->links);
    list.push_back({std::string(name), std::move(background), std::move(links)});
  }
  const TetMesh box = testing::box_tets(kBox.min(), kBox.max(), {4, 4, 3});
  list.push_back({"stored, by stars", BackgroundMesh(box), nullptr});
  list.push_back({"stored", BackgroundMesh(box), VertexLinks::listed(BackgroundMesh(box))});
  list.push_back({"stored, walls", BackgroundMesh(box), nullptr, true});
  list.push_back({"a15 in a box, walls", BackgroundMesh(a15_box(kBox, .9)), nullptr, true});
  return list;
}

IdSet labelled(const Place& place, const Labels& labels, std::mt19937& random) {
  IdSet inside(place.background.n_vertices());
  for (std::int64_t v = 0; v < place.background.n_vertices(); ++v) {
    if (!place.background.has_tets(v) || (!place.has_walls && place.background.on_boundary(v))) continue;
    if (labels(v, place.background.position(v), random)) inside.insert(v);
  }
  return inside;
}

/// omega_h of what make_manifold() leaves is a closed manifold by the count of its faces, which knows nothing of links.
ManifoldReport check(const Place& place, IdSet& inside, bool& is_empty) {
  const auto psi = testing::sphere();
  ClassificationParams params;
  if (const ConfigurationCosts* costs = configuration_costs(place.background.tiling())) params.costs = &costs->costs;
  const std::vector<std::int64_t> bad = vertices_not_manifold(place.background, place.links.get(), inside);
  const ManifoldReport report =
      make_manifold(place.background, place.links.get(), psi, params, place.has_walls, bad, inside);
  is_empty = inside.is_empty_around(0, place.background.n_vertices());
  if (is_empty) return report;
  const Submesh omega_h = emit_submesh(place.background, inside);
  const BoundaryFaces faces = boundary_faces(omega_h.mesh.C, omega_h.mesh.V.size());
  const SurfaceTopology surface = surface_topology(omega_h.mesh.V, faces.triangles);
  EXPECT_TRUE(surface.closed_manifold) << place.name;
  EXPECT_EQ(faces.n_overused + faces.n_same_side, 0u);
  if (!place.has_walls) {
    EXPECT_EQ(faces.triangles.size(), omega_h.positive_faces.size()) << place.name;
  }
  return report;
}

/// Of one kind after the other: random labels, thin sheets, checkerboards, contacts at a vertex, an edge or a face, and
/// a ball with a rough surface.
Labels labels_of(int kind, std::mt19937& random) {
  std::uniform_real_distribution<double> any(0, 1);
  const Vec3 n = Vec3(any(random) - .5, any(random) - .5, any(random) - .5).normalized();
  const double p = any(random);
  switch (kind) {
    case 0:
      return [p](std::int64_t, const Vec3&, std::mt19937& r) { return std::uniform_real_distribution(0., 1.)(r) < p; };
    case 1:
      return [n, p](std::int64_t, const Vec3& x, std::mt19937&) { return std::abs(n.dot(x) - p + .5) < .3 * p; };
    case 2: {
      const double s = 1.5 + 3 * p;
      return [s](std::int64_t, const Vec3& x, std::mt19937&) {
        return (Eigen::Array3d(s * x.array()).floor().cast<int>().sum() & 1) != 0;
      };
    }
    case 3: {
      const double r = .2 + .4 * p;
      return [n, r](std::int64_t, const Vec3& x, std::mt19937&) {
        return (x - r * n).norm() < r || (x + r * n).norm() < r;
      };
    }
    default:
      return [p](std::int64_t, const Vec3& x, std::mt19937& r) {
        return x.norm() + .4 * std::uniform_real_distribution(0., 1.)(r) < .6 + .3 * p;
      };
  }
}

TEST(ManifoldBoundary, ComesOfAnyClassificationOfAnyBackground) {
  std::mt19937 random(7);
  for (const Place& place : places()) {
    SCOPED_TRACE(place.name);
    const int n_tried = place.name == "cube" ? 1000 : 10000;  // a block of the cube alone has 1744 vertices
    std::size_t n_bad = 0, n_flips = 0, n_empty = 0;
    for (int k = 0; k < n_tried && !HasFailure(); ++k) {
      const Labels labels = labels_of(k % 5, random);
      IdSet inside = labelled(place, labels, random);
      bool is_empty = false;
      const ManifoldReport report = check(place, inside, is_empty);
      n_bad += report.n_bad, n_flips += report.flips.size(), n_empty += is_empty;
      EXPECT_TRUE(vertices_not_manifold(place.background, place.links.get(), inside).empty());
    }
    EXPECT_GT(n_bad, 1000u);
    EXPECT_LT(n_flips, n_bad);
    EXPECT_LT(n_empty, n_tried / 5);
  }
}

// They also want no vertex behind the boundary whose neighbours are all inside.
TEST(ManifoldBoundary, LinksFindAllThatStarsFind) {
  std::mt19937 random(3);
  for (const Place& place : places()) {
    if (!place.links) continue;
    for (int k = 0; k < 20; ++k) {
      const IdSet inside = labelled(place, labels_of(k % 5, random), random);
      const auto by_links = vertices_not_manifold(place.background, place.links.get(), inside);
      const auto by_stars = vertices_not_manifold(place.background, nullptr, inside);
      EXPECT_TRUE(std::includes(by_links.begin(), by_links.end(), by_stars.begin(), by_stars.end())) << place.name;
      EXPECT_LT(by_links.size(), 1.25 * static_cast<double>(by_stars.size()) + 10) << place.name;
    }
  }
}

TEST(ManifoldBoundary, StaysAsItIsWhereItIsOne) {
  const auto domain = testing::torus();
  const BackgroundMesh background(a15(), domain.box, .15);
  std::size_t n = 0;
  IdSet inside = inside_vertices(background, domain, n);
  const VertexLinks links(background, a15_links());
  classify_vertices(background, links, domain, {}, inside);
  const IdSet before = inside;
  const std::vector<std::int64_t> bad = vertices_not_manifold(background, &links, inside);
  EXPECT_TRUE(bad.empty());
  EXPECT_TRUE(make_manifold(background, &links, domain, {}, false, bad, inside).flips.empty());
  EXPECT_EQ(inside, before);
}

}  // namespace
}  // namespace umtet
