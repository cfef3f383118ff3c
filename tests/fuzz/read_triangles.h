#pragma once

#include <cmath>
#include <cstdlib>

#include "reconstruct/io/triangle_mesh_io.h"
#include "reconstruct/triangles/face_patches.h"
#include "reconstruct/triangles/face_sides.h"
#include "reconstruct/triangles/triangle_samples.h"
#include "reconstruct/triangles/triangle_winding.h"
#include "tests/fuzz/input_file.h"

namespace umtet::fuzz {

/// Triangles of finite corners that are there, no more than the file has bytes, which can be sampled; or a refusal.
inline int read_triangle_file(const InputFile& file, const std::uint8_t* data, std::size_t size) {
  const std::filesystem::path& path = file.write(data, size);
  if (!holds_triangles(path)) return 0;
  try {
    TriangleMesh mesh = read_triangles(path).mesh;
    require(mesh.F.size() <= size);
    require(mesh.labels.empty() || mesh.labels.size() == mesh.F.size());
    const auto n = static_cast<int>(mesh.V.size());
    for (const Triangle& f : mesh.F)
      for (const int v : f) require(v >= 0 && v < n && mesh.V[v].allFinite());
    drop_useless_faces(mesh);
    if (mesh.F.empty()) return 0;
    orient_outward(mesh);
    const TriangleWinding w(mesh);
    for (const Vec3& x : sample_triangles(mesh, diagonal_of(mesh) / 5).points)
      require(x.allFinite() && std::isfinite(w(x)));
  } catch (const CloudRefused&) {
  }
  return 0;
}

}  // namespace umtet::fuzz
