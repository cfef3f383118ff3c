#include "mesh/io/surface_files.h"

#include <array>
#include <cstdint>
#include <limits>
#include <stdexcept>

#include "mesh/base/check_indices.h"
#include "mesh/io/checked_file.h"

namespace umtet {
namespace {

using Vec3f = Eigen::Vector3f;

/// The surface over its own vertices, in single precision.
struct Surface {
  std::vector<Vec3f> V;
  std::vector<Triangle> faces;
};

Surface surface_of(const std::vector<Vec3>& V, const std::vector<Triangle>& faces) {
  check_indices(faces, V.size(), "face");
  std::vector<int> id(V.size(), -1);
  for (const Triangle& f : faces) {
    for (const int v : f) id[v] = 0;
  }
  Surface surface;
  for (std::size_t v = 0; v < V.size(); ++v) {
    if (id[v] < 0) continue;
    id[v] = static_cast<int>(surface.V.size());
    surface.V.push_back(V[v].cast<float>());
  }
  for (const Triangle& f : faces) surface.faces.push_back({id[f[0]], id[f[1]], id[f[2]]});
  return surface;
}

void write(CheckedFile& file, const Vec3f& x) {
  for (const float c : x) file.raw(c);
}

void write_stl(CheckedFile& file, const Surface& surface) {
  constexpr std::size_t kHeader = 80;
  if (surface.faces.size() > std::numeric_limits<std::uint32_t>::max()) {
    throw std::invalid_argument("write_surface: STL counts faces in 32 bits");
  }
  std::string header = "binary STL";  // not "solid", by which readers know text
  header.resize(kHeader, ' ');
  file.text(header).raw(static_cast<std::uint32_t>(surface.faces.size()));
  for (const Triangle& f : surface.faces) {
    const Vec3f &a = surface.V[f[0]], &b = surface.V[f[1]], &c = surface.V[f[2]];
    const Vec3 normal = (b - a).cast<double>().cross((c - a).cast<double>());
    write(file, normal.stableNormalized().cast<float>());
    for (const Vec3f* x : {&a, &b, &c}) write(file, *x);
    file.raw(std::uint16_t{0});
  }
}

void write_ply(CheckedFile& file, const Surface& surface) {
  file.text("ply\nformat binary_little_endian 1.0\nelement vertex ").number(surface.V.size());
  file.text("\nproperty float x\nproperty float y\nproperty float z\nelement face ").number(surface.faces.size());
  file.text("\nproperty list uchar int vertex_indices\nend_header\n");
  for (const Vec3f& x : surface.V) write(file, x);
  for (const Triangle& f : surface.faces) {
    file.raw(std::uint8_t{3});
    for (const int v : f) file.raw(v);
  }
}

void write_obj(CheckedFile& file, const Surface& surface) {
  for (const Vec3f& x : surface.V) {
    file.text("v");
    for (const float c : x) file.text(" ").number(c);
    file.text("\n");
  }
  for (const Triangle& f : surface.faces) {
    file.text("f");
    for (const int v : f) file.text(" ").number(v + 1);
    file.text("\n");
  }
}

}  // namespace

void write_surface(const std::filesystem::path& path, const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                   SurfaceFormat format) {
  const Surface surface = surface_of(V, faces);
  CheckedFile file(path);
  switch (format) {
    case SurfaceFormat::Stl:
      write_stl(file, surface);
      break;
    case SurfaceFormat::Obj:
      write_obj(file, surface);
      break;
    case SurfaceFormat::Ply:
      write_ply(file, surface);
      break;
  }
  file.close();
}

}  // namespace umtet
