#include "mesh/certify/certificate.h"

#include <oneapi/tbb/task_group.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/formatted.h"
#include "common/polled_loops.h"
#include "mesh/base/check_indices.h"
#include "mesh/certify/boundary_surface.h"
#include "mesh/certify/certificate_memory.h"
#include "mesh/certify/detail/tet_measures.h"
#include "mesh/certify/surface_measures.h"
#include "mesh/core/asking_psi.h"
#include "mesh/core/sort_faces.h"
#include "mesh/embedding/self_intersections.h"

namespace umtet {
namespace {

// A foot point takes half a dozen values of psi.
constexpr std::size_t kFeetPerPoll = kValuesPerPoll / 8;

/// Runs `here` in this thread and `aside` beside it in another, if there is one.
template <class Here, class Aside>
void run_both(const Here& here, const Aside& aside) {
  tbb::task_group group;
  group.run(aside);
  try {
    here();
  } catch (...) {
    group.wait();
    throw;
  }
  group.wait();
}

/// \pre the indices of x are in range
bool same_faces(std::vector<Triangle> x, std::vector<Triangle> y, std::size_t n_vertices) {
  if (x.size() != y.size()) return false;
  const auto is_out = [n = static_cast<int>(n_vertices)](int v) { return v < 0 || v >= n; };
  for (const Triangle& f : y) {
    if (std::any_of(f.begin(), f.end(), is_out)) return false;
  }
  const auto order = [n_vertices](std::vector<Triangle>& faces) {
    for (Triangle& f : faces) std::rotate(f.begin(), std::min_element(f.begin(), f.end()), f.end());
    sort_faces(faces, n_vertices);
  };
  run_both([&] { order(x); }, [&] { order(y); });
  return x == y;
}

/// The faces of `all` that are not among `others`, whose rotations may differ.
std::vector<Triangle> without(const std::vector<Triangle>& all, std::vector<Triangle> others) {
  const auto rotated = [](Triangle f) {
    std::rotate(f.begin(), std::min_element(f.begin(), f.end()), f.end());
    return f;
  };
  for (Triangle& f : others) f = rotated(f);
  std::sort(others.begin(), others.end());
  std::vector<Triangle> rest;
  for (const Triangle& f : all) {
    if (!std::binary_search(others.begin(), others.end(), rotated(f))) rest.push_back(f);
  }
  return rest;
}

std::vector<int> vertices_of(const std::vector<Triangle>& faces) {
  std::vector<int> all;
  for (const Triangle& f : faces) all.insert(all.end(), f.begin(), f.end());
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

/// The volume within a closed surface.
double enclosed_volume(const TetMesh& mesh, const std::vector<Triangle>& faces) {
  double six = 0;
  for (const Triangle& f : faces) {
    const Vec3& from = mesh.V[faces[0][0]];
    six += (mesh.V[f[0]] - from).dot((mesh.V[f[1]] - from).cross(mesh.V[f[2]] - from));
  }
  return std::abs(six) / 6;
}

/// The edge length of each vertex and face.
class EdgeOf {
 public:
  EdgeOf(double h, const std::vector<double>* local) : h_(h), local_(local) {}
  double operator()(int v) const { return local_ ? (*local_)[static_cast<std::size_t>(v)] : h_; }
  double operator()(const Triangle& f) const {
    return local_ ? ((*this)(f[0]) + (*this)(f[1]) + (*this)(f[2])) / 3 : h_;
  }

 private:
  double h_;
  const std::vector<double>* local_;
};

/// Fills the distances, normals and faults of the boundary.
/// @param volume  that the faces are to stand for
void measure_against(ImplicitFunctionRef psi, const TetMesh& mesh, const std::vector<Triangle>& faces,
                     const std::vector<int>& vertices, double volume, const std::vector<double>* local_h,
                     const Context& context, MeshCertificate& certificate) {
  const EdgeOf h(certificate.h, local_h);
  MeshCertificate::Boundary& boundary = certificate.boundary;
  std::vector<double> distance(vertices.size());
  for_each_asking(psi, vertices.size(), kValuesPerPoll, context,
                  [&](std::size_t i) { distance[i] = vertex_distance(psi, mesh.V[vertices[i]]); });
  std::vector<FaceMeasure> face(faces.size());
  for_each_asking(psi, faces.size(), kFeetPerPoll, context, [&](std::size_t i) {
    const Triangle& f = faces[i];
    face[i] = measure_face(psi, mesh.V[f[0]], mesh.V[f[1]], mesh.V[f[2]], h(f));
  });

  begin_distances(boundary);
  double gap = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const Vec3& x = mesh.V[vertices[i]];
    add_vertex(x, distance[i], h(vertices[i]), certificate.coordinate_rounding, boundary);
  }
  for (std::size_t i = 0; i < faces.size(); ++i) {
    add_face(face[i], h(faces[i]), boundary);
    if (face[i].found) add_gap(face[i], gap);
  }
  boundary.gap_over_volume = gap / volume;
}

/// @param memory  if not null, matched with the mesh
/// @param surface    receives the boundary
MeshCertificate certify_with(const CertificateInput& input, CertificateMemory* memory, BoundaryFaces& surface) {
  if (!input.mesh || input.mesh->C.empty()) throw std::invalid_argument("certify: a mesh with tets is needed");
  const TetMesh& mesh = *input.mesh;
  if (input.wall_faces && (!input.background_V || input.background_V->size() != mesh.V.size())) {
    throw std::invalid_argument("certify: walls need the vertices of the background, one for each of the mesh");
  }
  const std::vector<Triangle> walls = input.wall_faces ? *input.wall_faces : std::vector<Triangle>{};
  const std::vector<int> at_walls = vertices_of(walls);
  if (!at_walls.empty() && (at_walls.front() < 0 || at_walls.back() >= static_cast<int>(mesh.V.size()))) {
    throw std::invalid_argument("certify: a wall face with a vertex out of range");
  }
  input.context.poll();
  surface = boundary_faces(mesh.C, mesh.V.size(), memory ? memory->to_count() : nullptr);  // checks the indices
  input.context.poll();

  MeshCertificate certificate;
  certificate.coordinate_rounding = input.coordinate_rounding;
  SurfaceTopology topology;
  run_both([&] { detail::measure_tets(mesh, input.h, input.context, memory, certificate); },
           [&] { topology = surface_topology(mesh.V, surface.triangles); });

  MeshCertificate::Boundary& boundary = certificate.boundary;
  boundary.n_faces = surface.triangles.size();
  boundary.n_overused_faces = surface.n_overused;
  boundary.n_same_side_faces = surface.n_same_side;
  boundary.n_nonmanifold_edges = topology.n_nonmanifold_edges;
  boundary.n_nonmanifold_vertices = topology.n_nonmanifold_vertices;
  boundary.closed_manifold = topology.closed_manifold && surface.n_overused == 0 && surface.n_same_side == 0;
  boundary.n_self_intersections = self_intersections(mesh.V, surface.triangles, input.context).size();
  if (boundary.closed_manifold && boundary.n_self_intersections == 0) {
    boundary.n_wrongly_nested =
        wrongly_nested(mesh.V, surface.triangles, topology.component, topology.components.size(), input.context).size();
  }
  boundary.components = static_cast<int>(topology.components.size());
  boundary.euler_characteristic = topology.euler_characteristic;
  boundary.genus = topology.genus;
  boundary.area = topology.area;
  certificate.n_wall_faces = walls.size();
  if (input.positive_faces) {
    certificate.n_positive_faces = input.positive_faces->size();
    std::vector<Triangle> expected = *input.positive_faces;
    expected.insert(expected.end(), walls.begin(), walls.end());
    boundary.equals_positive_faces = same_faces(surface.triangles, std::move(expected), mesh.V.size());
  }
  for (const int i : at_walls) boundary.n_moved_wall_vertices += mesh.V[i] != (*input.background_V)[i];
  if (input.psi) {
    if (walls.empty()) {
      measure_against(*input.psi, mesh, surface.triangles, topology.vertices, certificate.volume, input.local_h,
                      input.context, certificate);
    } else {
      const std::vector<Triangle> fitted = without(surface.triangles, walls);
      // Relative to the body, if that is less: else the gap around a small body in much fluid would not count.
      const double volume =
          fitted.empty() ? certificate.volume : std::min(certificate.volume, enclosed_volume(mesh, fitted));
      measure_against(*input.psi, mesh, fitted, vertices_of(fitted), volume, input.local_h, input.context, certificate);
    }
  }
  return certificate;
}

/// Of a mesh that has not changed, without walls: faces are compared and psi is evaluated again.
MeshCertificate certify_again(const CertificateInput& input, CertificateMemory::Whole& known,
                              const std::vector<Triangle>& surface) {
  MeshCertificate certificate = known.certificate;
  certificate.coordinate_rounding = input.coordinate_rounding;
  certificate.n_positive_faces = input.positive_faces ? input.positive_faces->size() : 0;
  MeshCertificate::Boundary& boundary = certificate.boundary;
  boundary.equals_positive_faces.reset();
  if (input.positive_faces)
    boundary.equals_positive_faces = same_faces(surface, *input.positive_faces, input.mesh->V.size());
  boundary.max_vertex_distance_over_h.reset();
  boundary.max_centroid_distance_over_h.reset();
  boundary.min_cos_normal.reset();
  boundary.gap_over_volume.reset();
  boundary.faults.clear();
  boundary.far_feet.clear();
  boundary.n_cos_below_half = boundary.n_unprojected_faces = 0;
  if (input.psi) {
    if (known.surface_vertices.empty()) known.surface_vertices = vertices_of(surface);
    measure_against(*input.psi, *input.mesh, surface, known.surface_vertices, certificate.volume, input.local_h,
                    input.context, certificate);
  }
  return certificate;
}

}  // namespace

MeshCertificate certify(const CertificateInput& input) {
  BoundaryFaces surface;
  return certify_with(input, nullptr, surface);
}

MeshCertificate certify(const CertificateInput& input, const std::vector<std::int64_t>& vertex_id,
                        const std::vector<std::int64_t>& tet_id, CertificateMemory& memory) {
  if (!input.mesh) throw std::invalid_argument("certify: a mesh with tets is needed");
  check_indices(input.mesh->C, input.mesh->V.size(), "tet");
  memory.match(*input.mesh, vertex_id, tet_id);
  if (auto* known = memory.of_the_same(input.h); known && !input.wall_faces) {
    memory.keep();
    return certify_again(input, *known, memory.single_faces());
  }
  BoundaryFaces surface;
  MeshCertificate certificate = certify_with(input, &memory, surface);
  memory.remember(*input.mesh, vertex_id, tet_id, surface);
  if (!input.wall_faces) memory.remember({input.h, certificate});
  return certificate;
}

namespace {

void count(std::size_t n, const char* what, std::vector<std::string>& reasons) {
  if (n > 0) reasons.push_back(std::to_string(n) + " " + what);
}

}  // namespace

std::vector<std::string> invalidities(const MeshCertificate& certificate) {
  std::vector<std::string> reasons;
  const MeshCertificate::Boundary& b = certificate.boundary;
  count(certificate.quality.n_inverted, "tets are inverted or flat (exact sign of the volume)", reasons);
  count(b.n_overused_faces, "faces belong to more than two tets", reasons);
  count(b.n_same_side_faces, "faces have both their tets on the same side", reasons);
  count(b.n_nonmanifold_edges, "boundary edges do not have exactly two boundary faces", reasons);
  count(b.n_nonmanifold_vertices, "boundary vertices join more than one fan of boundary faces", reasons);
  if (!b.closed_manifold) reasons.emplace_back("the boundary is not a closed 2-manifold");
  count(b.n_self_intersections, "pairs of boundary faces pass through each other", reasons);
  count(b.n_wrongly_nested, "pieces of the boundary are within a body, or around nothing", reasons);
  if (b.equals_positive_faces == false) {
    reasons.push_back(
        "the boundary (" + std::to_string(b.n_faces) + " faces) is not the set of positive faces (" +
        std::to_string(certificate.n_positive_faces) + ")" +
        (certificate.n_wall_faces > 0 ? " and wall faces (" + std::to_string(certificate.n_wall_faces) + ")" : ""));
  }
  count(b.n_moved_wall_vertices, "vertices of the walls have left their places", reasons);
  return reasons;
}

std::vector<std::string> coarseness(const MeshCertificate& certificate) {
  const std::optional<double>& gap = certificate.boundary.gap_over_volume;
  if (!gap || *gap <= kMostGap) return {};
  return {
      formatted("volume_gap: between the flat faces and psi = 0 lies %.3g %% of the volume of the mesh, or of the "
                "body in it, more than %.3g %%: h is too large for this shape",
                100 * *gap, 100 * kMostGap)};
}

std::vector<std::string> failures(const MeshCertificate& certificate) {
  std::vector<std::string> reasons = invalidities(certificate);
  const MeshCertificate::Boundary& b = certificate.boundary;
  if (b.max_vertex_distance_over_h &&
      !(*b.max_vertex_distance_over_h <= vertex_tolerance(certificate.coordinate_rounding, certificate.h))) {
    reasons.push_back(formatted("a boundary vertex is %.3g h from psi = 0, more than rounding explains",
                                *b.max_vertex_distance_over_h));
  }
  count(b.n_unprojected_faces, "boundary faces have no point of psi = 0 near their centroid", reasons);
  if (b.min_cos_normal && !(*b.min_cos_normal > 0)) {
    reasons.push_back(
        formatted("the boundary is folded: cos(face normal, grad psi) is down to %.3g", *b.min_cos_normal));
  }
  for (std::string& reason : coarseness(certificate)) reasons.push_back(std::move(reason));
  return reasons;
}

}  // namespace umtet
