#include "body/patches/boundary_division.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "body/errors.h"
#include "mesh/io/solver_mesh.h"
#include "mesh/patches/patches.h"
#include "tests/support/tet_shapes.h"

namespace umtet {
namespace {

/// The boundary of a box of 4 x 4 x 4 cubes, and of two such boxes.
struct Boxes : ::testing::Test {
  const SolverMesh one = solver_mesh(testing::cubes(4, [](int, int, int) { return true; }));
  const SolverMesh two = solver_mesh(testing::cubes(5, [](int i, int, int) { return i != 3; }));
  static BoundaryDivision divided(const SolverMesh& mesh, const PatchOptions& options,
                                  const std::vector<char>& at_wall = {}, const OrientedPointCloud& cloud = {}) {
    return divide_boundary(mesh.nodes, mesh.triangles(), at_wall, cloud, options);
  }
  /// Flags of the faces in a plane x = const.
  static std::vector<char> faces_at(const SolverMesh& mesh, double x) {
    std::vector<char> flags;
    for (const Vec3& c : face_geometry(mesh.nodes, mesh.triangles()).centroid)
      flags.push_back(std::abs(c.x() - x) < 1e-9 ? 1 : 0);
    return flags;
  }
  static std::vector<std::string> names(const BoundaryDivision& division) {
    std::vector<std::string> list;
    for (const MeshPart& part : division.patches) list.push_back(part.name + ' ' + std::to_string(part.number));
    return list;
  }
};

using Names = std::vector<std::string>;

TEST_F(Boxes, AreDividedAsTheOptionsSay) {
  EXPECT_EQ(names(divided(one, {})), Names{"boundary 2"});
  EXPECT_EQ(names(divided(two, {})), (Names{"boundary_1 2", "boundary_2 3"}));
  EXPECT_EQ(divided(one, {.angle = 30}).patches.size(), 6u);
  EXPECT_EQ(divided(one, {.angle = 91}).patches.size(), 1u);
  const BoundaryDivision planes = divided(one, {.angle = 30, .planar = 5});
  EXPECT_EQ(names(planes), (Names{"plane_1 2", "plane_2 3", "plane_3 4", "plane_4 5", "plane_5 6", "plane_6 7"}));
  EXPECT_EQ(planes.face_patch.size(), one.n_faces());
}

TEST_F(Boxes, HaveWallsAsSeparatePatches) {
  const std::vector<char> walls = faces_at(one, 0);
  const BoundaryDivision division = divided(one, {.angle = 30}, walls);
  EXPECT_EQ(division.patches.back().name, "walls");
  for (std::size_t f = 0; f < walls.size(); ++f) EXPECT_EQ(division.face_patch[f] == 5, walls[f] == 1);
  const std::vector<char> all(one.n_faces(), 1);
  const BoundaryDivision flat = divided(one, {.planar = 5}, all);
  EXPECT_EQ(flat.notices, Names{"no part of the boundary is flat within 5 degrees"});
}

TEST_F(Boxes, HaveThePatchesOfLabels) {
  OrientedPointCloud cloud;
  const FaceGeometry faces = face_geometry(one.nodes, one.triangles());
  cloud.points = faces.centroid;
  cloud.normals = faces.normal;
  for (const Vec3& x : cloud.points) cloud.labels.push_back(x.x() < 2 ? -4 : 9);
  cloud.labels.front() = 20;  // an island
  const std::vector<char> walls = faces_at(one, 4);
  const BoundaryDivision division = divided(one, {.angle = 30, .names = {{9, "right"}}}, walls, cloud);
  EXPECT_EQ(names(division), (Names{"patch_m4 10", "right 9", "walls 11"}));
  EXPECT_EQ(division.notices,
            Names{"no boundary face has label 20 (patch_20): too few samples for faces of this size"});
  for (std::size_t f = 0; f < walls.size(); ++f)
    EXPECT_EQ(division.face_patch[f], walls[f] ? 2 : cloud.points[f].x() < 2 ? 0 : 1);
  cloud.labels.back() = std::numeric_limits<int>::max();
  EXPECT_THROW(require_patches(cloud, {}), UsageError);
}

TEST_F(Boxes, HaveThePatchesOfABodyWithSharpEdgesAndTheirCurves) {
  const std::vector<char> none = faces_at(one, 0), third = faces_at(one, 4);
  std::vector<int> of_body;
  for (std::size_t f = 0; f < none.size(); ++f) of_body.push_back(none[f] ? -1 : third[f] ? 2 : 0);
  const auto divided_by = [&](const PatchOptions& options, const std::vector<int>& patches) {
    return divide_boundary(one.nodes, one.triangles(), {}, {}, options, patches);
  };
  const BoundaryDivision division = divided_by({}, of_body);
  EXPECT_EQ(names(division), (Names{"rest 2", "patch_1 3", "patch_3 4"}));
  for (std::size_t f = 0; f < none.size(); ++f) EXPECT_EQ(division.face_patch[f], none[f] ? 0 : third[f] ? 2 : 1);
  ASSERT_EQ(division.curves.size(), 2u);
  for (int c = 0; c < 2; ++c) {
    const MeshCurve& curve = division.curves[c];
    EXPECT_EQ(curve.part.name, c == 0 ? "curve_1" : "curve_2");
    EXPECT_EQ(curve.part.number, c + 1);
    EXPECT_EQ(curve.edges.size(), 16u) << "around a side of 4 x 4 squares";
    for (const auto& [v, w] : curve.edges) EXPECT_EQ(one.nodes[v].x() + one.nodes[w].x(), 8 * c);
  }
  const BoundaryDivision by_angle = divided_by({.angle = 30}, of_body);
  EXPECT_EQ(by_angle.patches.size(), 6u);
  EXPECT_TRUE(by_angle.curves.empty());
  EXPECT_EQ(names(divided_by({}, std::vector<int>(none.size(), 3))), Names{"boundary 2"});
}

TEST_F(Boxes, LoseFacesToHoles) {
  const BoundaryDivision sides = divided(one, {.angle = 30});
  const std::vector<char> holes = faces_at(one, 0);
  BoundaryDivision division = sides;
  take_holes({}, division);
  EXPECT_EQ(division.face_patch, sides.face_patch);
  take_holes(holes, division);
  ASSERT_EQ(division.patches.size(), 6u) << "a side is gone";
  EXPECT_EQ(division.patches.back().name, "closed_holes");
  EXPECT_EQ(division.patches.back().number, 8);
  EXPECT_EQ(division.notices.size(), 1u);
  for (std::size_t f = 0; f < holes.size(); ++f) {
    const int before = sides.patches[sides.face_patch[f]].number,
              after = division.patches[division.face_patch[f]].number;
    EXPECT_EQ(after, holes[f] ? 8 : before);
  }
  BoundaryDivision whole = divided(one, {});
  take_holes(holes, whole);
  EXPECT_EQ(names(whole), (Names{"boundary_1 2", "closed_holes 3"}));
}

TEST_F(Boxes, AnglesOutOfRangeAreRefused) {
  for (const PatchOptions& options : {PatchOptions{.angle = -1}, {.angle = 181}, {.planar = 90}, {.planar = -1}})
    EXPECT_THROW(divided(one, options), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
