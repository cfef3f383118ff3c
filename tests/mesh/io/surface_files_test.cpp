#include "mesh/io/surface_files.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <system_error>

#include "mesh/certify/boundary_surface.h"
#include "tests/support/tet_shapes.h"

namespace umtet {
namespace {

// Two counts that share no code: ours over sorted indices, OpenMesh's over half-edges.
TEST(CountHalfEdges, AgreesWithSurfaceTopologyOnDamagedSpheres) {
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

TEST(CountHalfEdges, RefusesBodiesThatShareAnEdge) {
  const TetMesh touching = testing::cubes(2, [](int i, int j, int k) { return i == j && k == 0; });
  const std::vector<Triangle> surface = boundary_faces(touching.C, touching.V.size()).triangles;
  EXPECT_GT(count_half_edges(touching.V, surface).n_refused_faces, 0u);
  EXPECT_FALSE(surface_topology(touching.V, surface).closed_manifold);
}

TEST(WriteSurface, FilesAreCompleteAndAFullDiskIsAnError) {
  std::vector<Triangle> faces;
  const TetMesh sphere = testing::sphere_surface(2, faces);
  const std::filesystem::path folder(::testing::TempDir());
  write_surface(folder / "umtet_skin.stl", sphere.V, faces, SurfaceFormat::Stl);
  EXPECT_EQ(std::filesystem::file_size(folder / "umtet_skin.stl"), 84 + 50 * faces.size());
  write_surface(folder / "umtet_skin.ply", sphere.V, faces, SurfaceFormat::Ply);
  std::ifstream ply(folder / "umtet_skin.ply", std::ios::binary);
  std::ostringstream bytes;
  bytes << ply.rdbuf();
  const std::string head = bytes.str().substr(0, bytes.str().find("end_header\n") + 11);
  EXPECT_EQ(bytes.str().size(), head.size() + 12 * sphere.V.size() + 13 * faces.size());
  write_surface(folder / "umtet_skin.obj", sphere.V, faces, SurfaceFormat::Obj);
  std::ifstream obj(folder / "umtet_skin.obj");
  std::size_t n_v = 0, n_f = 0;
  for (std::string line; std::getline(obj, line);) {
    n_v += line.starts_with("v ");
    n_f += line.starts_with("f ");
  }
  EXPECT_EQ(n_v, sphere.V.size());
  EXPECT_EQ(n_f, faces.size());
  for (const char* name : {"umtet_skin.stl", "umtet_skin.ply", "umtet_skin.obj"})
    std::filesystem::remove(folder / name);

  EXPECT_THROW(write_surface("/dev/full", sphere.V, faces, SurfaceFormat::Ply), std::system_error);
  EXPECT_THROW(write_surface("/nowhere/surface.stl", sphere.V, faces, SurfaceFormat::Stl), std::system_error);
}

}  // namespace
}  // namespace umtet
