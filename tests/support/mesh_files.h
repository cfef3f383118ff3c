#pragma once

// A mesh, the formats that we read and write, and files of them in a folder of their own.

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include "mesh/certify/boundary_surface.h"
#include "mesh/io/solver_files.h"
#include "mesh/io/tet_mesh_io.h"
#include "tests/support/tet_shapes.h"

namespace umtet::test {

namespace fs = std::filesystem;

inline fs::path scratch(const std::string& name) {
  return fs::path(::testing::TempDir()) / ("umtet_io_" + std::to_string(::getpid()) + "_" + name);
}

inline std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

inline fs::path with_bytes(const std::string& name, const std::string& bytes) {
  const fs::path path = scratch(name);
  std::ofstream(path, std::ios::binary) << bytes;
  return path;
}

struct Shape {
  TetMesh mesh;
  std::vector<Triangle> boundary;
};

/// Coordinates with all their bits in use, and one mixed with tiny and huge values.
inline Shape sample(int n = 3) {
  Shape s;
  s.mesh = testing::cubes(n, [](int, int, int) { return true; });
  testing::perturb(s.mesh, 0.1, 5);
  s.mesh.V[0] *= 1e-30;
  s.mesh.V[1].x() += 1e9;
  s.mesh.V[2].y() = -0.0;
  s.boundary = boundary_faces(s.mesh.C, s.mesh.V.size()).triangles;
  return s;
}

struct Format {
  std::string name;
  std::function<void(const fs::path&, const Shape&)> write;
};

inline std::vector<Format> formats() {
  return {
      {"a.vtu", [](const fs::path& p, const Shape& s) { write_vtu(p, with_standard_data(s.mesh, {}, {})); }},
      {"a22.msh", [](const fs::path& p, const Shape& s) { write_msh22(p, solver_mesh(s.mesh), MshEncoding::Ascii); }},
      {"b22.msh", [](const fs::path& p, const Shape& s) { write_msh22(p, solver_mesh(s.mesh), MshEncoding::Binary); }},
      {"a41.msh", [](const fs::path& p, const Shape& s) { write_msh41(p, solver_mesh(s.mesh), MshEncoding::Ascii); }},
      {"b41.msh", [](const fs::path& p, const Shape& s) { write_msh41(p, solver_mesh(s.mesh), MshEncoding::Binary); }},
      {"a.mesh", [](const fs::path& p, const Shape& s) { write_medit(p, solver_mesh(s.mesh)); }}};
}

/// The reason a file is refused for, or what went wrong.
inline std::string refusal(const fs::path& path) {
  try {
    read_tet_mesh(path);
    return "accepted";
  } catch (const MeshFileRefused& e) {
    return e.what();
  }
}

}  // namespace umtet::test
