#include "mesh/io/surface_files.h"

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/System/omstream.hh>
#include <algorithm>
#include <limits>
#include <mutex>
#include <sstream>
#include <stdexcept>
#include <string>

#include "mesh/base/check_indices.h"
#include "mesh/io/checked_file.h"

namespace umtet {
namespace {

struct SurfaceTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
};
using HalfEdgeMesh = OpenMesh::TriMesh_ArrayKernelT<SurfaceTraits>;

/// OpenMesh reports complex edges and written files on its global streams; a library of ours prints nothing.
class QuietOpenMesh {
 public:
  QuietOpenMesh() : lock_(mutex()), err_(omerr().is_enabled()), log_(omlog().is_enabled()) {
    omerr().disable();
    omlog().disable();
  }
  ~QuietOpenMesh() {
    if (err_) omerr().enable();
    if (log_) omlog().enable();
  }
  QuietOpenMesh(const QuietOpenMesh&) = delete;
  QuietOpenMesh& operator=(const QuietOpenMesh&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex m;
    return m;
  }
  std::lock_guard<std::mutex> lock_;
  bool err_, log_;
};

/// The surface as half-edges, over its own vertices; `refused` counts the faces that do not fit a 2-manifold.
HalfEdgeMesh half_edges(const std::vector<Vec3>& V, const std::vector<Triangle>& faces, std::size_t& refused) {
  check_indices(faces, V.size(), "face");
  std::vector<int> vertices;
  for (const Triangle& f : faces) vertices.insert(vertices.end(), f.begin(), f.end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  HalfEdgeMesh mesh;
  mesh.reserve(vertices.size(), 3 * faces.size() / 2, faces.size());
  std::vector<OpenMesh::VertexHandle> handle(V.size());
  for (const int v : vertices) handle[v] = mesh.add_vertex(OpenMesh::Vec3d(V[v].x(), V[v].y(), V[v].z()));
  const QuietOpenMesh quiet;
  refused = 0;
  for (const Triangle& f : faces) refused += !mesh.add_face(handle[f[0]], handle[f[1]], handle[f[2]]).is_valid();
  return mesh;
}

}  // namespace

HalfEdgeCount count_half_edges(const std::vector<Vec3>& V, const std::vector<Triangle>& faces) {
  HalfEdgeCount count;
  const HalfEdgeMesh mesh = half_edges(V, faces, count.n_refused_faces);
  count.has_boundary =
      std::any_of(mesh.halfedges_begin(), mesh.halfedges_end(), [&](const auto h) { return mesh.is_boundary(h); });
  return count;
}

void write_surface(const std::filesystem::path& path, const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                   SurfaceFormat format) {
  std::size_t refused = 0;
  const HalfEdgeMesh mesh = half_edges(V, faces, refused);
  if (refused > 0) {
    throw std::invalid_argument("cannot write " + path.string() + ": " + std::to_string(refused) +
                                " faces do not fit a manifold");
  }
  const char* const extension = format == SurfaceFormat::Stl ? ".stl" : format == SurfaceFormat::Obj ? ".obj" : ".ply";
  OpenMesh::IO::Options options = OpenMesh::IO::Options::Default;
  if (format != SurfaceFormat::Obj) options += OpenMesh::IO::Options::Binary;
  const QuietOpenMesh quiet;
  std::ostringstream out;  // OpenMesh calls a cut file a success, so it writes to memory and we write the file
  const bool written =
      OpenMesh::IO::write_mesh(mesh, out, extension, options, std::numeric_limits<float>::max_digits10);
  if (!written || !out) throw std::runtime_error("cannot write " + path.string() + ": OpenMesh gave up");
  CheckedFile file(path);
  file.text(out.view());
  file.close();
}

}  // namespace umtet
