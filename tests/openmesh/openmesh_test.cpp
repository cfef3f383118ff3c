// umtet::openmesh, and OpenMesh's half-edges as a second opinion on our topology of surfaces.

#include <gtest/gtest.h>
#include <umtet/openmesh.h>

#include <OpenMesh/Core/System/omstream.hh>
#include <algorithm>
#include <random>

#include "mesh/certify/boundary_surface.h"
#include "tests/support/tet_shapes.h"

namespace umtet {
namespace {

/// OpenMesh reports complex edges on a global stream.
class OpenMeshTest : public ::testing::Test {
 protected:
  OpenMeshTest() { omerr().disable(); }
  ~OpenMeshTest() override { omerr().enable(); }
};

using CountHalfEdges = OpenMeshTest;
using OpenMeshSurfaces = OpenMeshTest;

struct HalfEdgeCount {
  std::size_t n_refused_faces = 0;  ///< faces it cannot hold, because they would make the surface no 2-manifold
  bool has_boundary = false;        ///< a half-edge without a face
};

HalfEdgeCount count_half_edges(const std::vector<Vec3>& V, const std::vector<Triangle>& faces) {
  OpenMeshSurface mesh;
  std::vector<OpenMesh::VertexHandle> handle;
  for (const Vec3& x : V) handle.push_back(mesh.add_vertex({x.x(), x.y(), x.z()}));
  HalfEdgeCount count;
  for (const Triangle& f : faces) {
    count.n_refused_faces += !mesh.add_face(handle[f[0]], handle[f[1]], handle[f[2]]).is_valid();
  }
  mesh.request_vertex_status();
  mesh.request_edge_status();
  mesh.request_face_status();
  mesh.delete_isolated_vertices();
  mesh.garbage_collection();
  count.has_boundary =
      std::any_of(mesh.halfedges_begin(), mesh.halfedges_end(), [&](const auto h) { return mesh.is_boundary(h); });
  return count;
}

// Two counts that share no code: ours over sorted indices, OpenMesh's over half-edges.
TEST_F(CountHalfEdges, AgreesWithSurfaceTopologyOnDamagedSpheres) {
  std::vector<Triangle> sphere;
  const TetMesh ball = testing::sphere_surface(2, sphere);
  std::mt19937 random(1);
  const auto any_face = [&] { return std::uniform_int_distribution<std::size_t>(0, sphere.size() - 1)(random); };
  std::size_t n_closed = 0;
  for (int round = 0; round < 200; ++round) {
    std::vector<Triangle> faces = sphere;
    std::shuffle(faces.begin(), faces.end(), random);
    if (round % 4 == 1) faces.erase(faces.begin() + static_cast<std::ptrdiff_t>(any_face()));
    if (round % 4 == 2) std::swap(faces[0][0], faces[0][1]);
    if (round % 4 == 3) faces.push_back(faces[any_face()]);
    if (round % 8 >= 4) {  // inside out
      for (Triangle& f : faces) std::swap(f[0], f[1]);
    }
    const SurfaceTopology ours = surface_topology(ball.V, faces);
    const HalfEdgeCount theirs = count_half_edges(ball.V, faces);
    EXPECT_EQ(ours.closed_manifold, theirs.n_refused_faces == 0 && !theirs.has_boundary) << "round " << round;
    n_closed += ours.closed_manifold;
    EXPECT_EQ(ours.closed_manifold, round % 4 == 0);
  }
  EXPECT_EQ(n_closed, 50u);
}

TEST_F(CountHalfEdges, RefusesBodiesThatShareAnEdge) {
  const TetMesh touching = testing::cubes(2, [](int i, int j, int k) { return i == j && k == 0; });
  const std::vector<Triangle> surface = boundary_faces(touching.C, touching.V.size()).triangles;
  EXPECT_GT(count_half_edges(touching.V, surface).n_refused_faces, 0u);
  EXPECT_FALSE(surface_topology(touching.V, surface).closed_manifold);
}

/// Three cubes in a row with the face at x = 0 as a patch of its own.
SolverMesh bar() {
  SolverMesh mesh = solver_mesh(testing::cubes(3, [](int, int j, int k) { return j == 0 && k == 0; }));
  std::vector<int> patch;
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
    const std::array<int, 6> ids = mesh.face(f);
    const bool is_end = std::all_of(ids.begin(), ids.begin() + 3, [&](int v) {
      return mesh.nodes[static_cast<std::size_t>(v)].x() == mesh.nodes[0].x();
    });
    patch.push_back(is_end ? 1 : 0);
  }
  set_patches(mesh, patch, {{"sides", 7}, {"end", 9}});
  return mesh;
}

TEST_F(OpenMeshSurfaces, BoundaryOfATetMeshComesBackWithItsPatches) {
  const SolverMesh mesh = bar();
  const OpenMeshSurface surface = to_openmesh(mesh);
  ASSERT_EQ(surface.n_faces(), mesh.n_faces());
  EXPECT_TRUE(std::none_of(surface.halfedges_begin(), surface.halfedges_end(),
                           [&](const auto h) { return surface.is_boundary(h); }));
  const TriangleMesh back = from_openmesh(surface);
  ASSERT_EQ(back.F.size(), mesh.n_faces());
  std::size_t n_end = 0;
  for (std::size_t f = 0; f < back.F.size(); ++f) {
    const std::array<int, 6> ids = mesh.face(f);
    for (int k = 0; k < 3; ++k) {
      bool is_there = false;
      for (int j = 0; j < 3; ++j) is_there |= back.corner(f, k) == mesh.nodes[static_cast<std::size_t>(ids[j])];
      EXPECT_TRUE(is_there) << f;
    }
    EXPECT_EQ(back.labels[f], mesh.face_patch[f] == 1 ? 9 : 7);
    n_end += back.labels[f] == 9;
  }
  EXPECT_GT(n_end, 0u);
  EXPECT_LT(n_end, back.F.size());
}

TEST_F(OpenMeshSurfaces, FacesKeepTheirOrientation) {
  const SolverMesh mesh = bar();
  const TriangleMesh back = from_openmesh(to_openmesh(mesh));
  const std::vector<SurfaceComponent> components = surface_topology(back.V, back.F).components;
  ASSERT_EQ(components.size(), 1u);
  EXPECT_GT(components[0].volume, 0);
}

TEST_F(OpenMeshSurfaces, DeletedFacesAndOtherTraitsAreTaken) {
  OpenMesh::TriMesh_ArrayKernelT<> mesh;  // single precision
  mesh.request_vertex_status();
  mesh.request_edge_status();
  mesh.request_face_status();
  std::vector<OpenMesh::VertexHandle> v;
  for (int i = 0; i < 4; ++i) v.push_back(mesh.add_vertex({float(i == 1), float(i == 2), float(i == 3)}));
  const auto first = mesh.add_face(v[0], v[2], v[1]);
  mesh.add_face(v[0], v[1], v[3]);
  mesh.delete_face(first, true);
  const TriangleMesh made = from_openmesh(mesh);
  ASSERT_EQ(made.F.size(), 1u);
  EXPECT_EQ(made.V.size(), 3u) << "vertex 2 has no face any more";
  EXPECT_TRUE(made.labels.empty());
  EXPECT_EQ(made.corner(0, 2), Vec3(0, 0, 1));
}

TEST_F(OpenMeshSurfaces, ABoundaryThatIsNoManifoldIsRefused) {
  EXPECT_THROW(to_openmesh(solver_mesh(testing::cubes(2, [](int i, int j, int k) { return i == j && k == 0; }))),
               std::invalid_argument);
}

}  // namespace
}  // namespace umtet
