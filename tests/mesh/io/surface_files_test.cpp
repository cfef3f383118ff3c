#include "mesh/io/surface_files.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <system_error>

#include "tests/support/tet_shapes.h"

namespace umtet {
namespace {

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
