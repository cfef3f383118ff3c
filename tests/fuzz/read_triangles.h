#pragma once

#include <algorithm>
#include <cstdlib>

#include "reconstruct/io/triangle_mesh_io.h"
#include "reconstruct/triangles/body_samples.h"
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
    const double spacing = diagonal_of(mesh) / 5;
    const BodySamples body = sample_body(std::move(mesh), {.spacing = spacing});
    for (const Vec3& x : body.cloud.points) require(x.allFinite());
    for (const Vec3& normal : body.cloud.normals) require(std::abs(normal.norm() - 1) < 1e-9);
  } catch (const CloudRefused&) {
  } catch (const std::invalid_argument&) {  // no triangle has an area
  }
  return 0;
}

}  // namespace umtet::fuzz
