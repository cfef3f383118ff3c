#pragma once

#include <cstdlib>

#include "mesh/io/tet_mesh_io.h"
#include "tests/fuzz/input_file.h"

namespace umtet::fuzz {

/// A mesh whose tets have four different finite vertices, and data of its size; or a refusal.
inline int read_mesh(const InputFile& file, const std::uint8_t* data, std::size_t size) {
  try {
    const MeshFile read = read_tet_mesh(file.write(data, size));
    const auto n = static_cast<int>(read.mesh.V.size());
    for (const Eigen::Vector3d& x : read.mesh.V) require(x.allFinite());
    for (const Tet& tet : read.mesh.C)
      for (int k = 0; k < 4; ++k) require(tet[k] >= 0 && tet[k] < n && tet[k] != tet[(k + 1) % 4]);
    const auto has = [](std::size_t wanted) {
      return [wanted](const auto& values) { return values.size() == wanted; };
    };
    for (const auto& [name, values] : read.point_data) require(std::visit(has(read.mesh.V.size()), values));
    for (const auto& [name, values] : read.cell_data) require(std::visit(has(read.mesh.C.size()), values));
    if (!read.quadratic) return 0;
    for (const auto& tet : read.quadratic->C)
      for (const int v : tet) require(v >= 0 && v < static_cast<int>(read.quadratic->V.size()));
  } catch (const MeshFileRefused&) {
  }
  return 0;
}

}  // namespace umtet::fuzz
