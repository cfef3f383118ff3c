#include "pipeline/memory/mesh_object.h"

#include <algorithm>
#include <array>
#include <map>
#include <stdexcept>
#include <utility>

#include "mesh/io/solver_files.h"
#include "mesh/io/surface_files.h"
#include "mesh/io/tet_mesh_io.h"
#include "pipeline/meshing/made_mesh.h"
#include "pipeline/meshing/second_order_file.h"
#include "pipeline/output/boundary_patches.h"

namespace umtet {
namespace {

SolverMesh all_of(const MeshObject& m, const MeshFile& content) {
  if (!m.second) return solver_mesh(content.mesh);
  QuadraticTetMesh curved = m.second->mesh;
  for (Vec3& x : curved.V) x += m.domain.shift;
  return solver_mesh(curved);
}

/// Returns the mesh with the holes of the certificate as a patch.
SolverMesh for_solver(const MeshObject& m, const MeshFile& content) {
  SolverMesh made = all_of(m, content);
  if (!m.certificate) return made;
  MarkedFaces marked = marked_faces(made, content, m.certificate->measured.domain.support);
  mark_patches(m.domain, made, m.result.final, m.h, marked);
  const Warn nobody = [](const std::string&) {};
  if (marked.of_body.empty()) {
    take_holes(made, marked.in_holes, nobody);
  } else {
    divide_boundary(made, marked, {}, {}, nobody);
  }
  return made;
}

}  // namespace

Domain without_psi(Domain&& domain) {
  Domain left;
  left.shift = domain.shift;
  left.cloud = std::move(domain.cloud);
  left.piecewise = std::move(domain.piecewise);
  left.notices = std::move(domain.notices);
  return left;
}

MeshObject mesh_object(Domain&& domain, MeshAttempt&& made, const Parameters& parameters) {
  return {without_psi(std::move(domain)), std::move(made.result), std::move(made.second), made.h,
          verdict_on(std::move(made.measured), parameters)};
}

std::vector<int> MeshObject::boundary_nodes() const {
  std::vector<int> nodes = result.submesh.positive_vertices;
  if (second) nodes.insert(nodes.end(), second->boundary_mid_sides.begin(), second->boundary_mid_sides.end());
  return nodes;
}

std::vector<std::int64_t> MeshObject::background_vertices() const {
  std::vector<std::int64_t> ids(result.submesh.background_vertex.begin(), result.submesh.background_vertex.end());
  ids.resize(nodes().size(), -1);
  return ids;
}

std::vector<QuadraticTriangle> MeshObject::curved_boundary() const {
  const std::vector<int>& mid_sides = second->boundary_mid_sides;
  std::map<std::pair<int, int>, int> between;  // key: corners, the smaller one first
  for (const QuadraticTet& t : second->mesh.C) {
    for (int k = 0; k < 6; ++k) {
      const auto [p, q] = kMidSideEdge[k];
      const int mid = t[4 + k];
      if (std::binary_search(mid_sides.begin(), mid_sides.end(), mid)) between[std::minmax(t[p], t[q])] = mid;
    }
  }
  const auto mid = [&](int a, int b) { return between.at(std::minmax(a, b)); };
  std::vector<QuadraticTriangle> faces;
  for (const auto& [a, b, c] : result.submesh.positive_faces) {
    faces.push_back({a, b, c, mid(a, b), mid(b, c), mid(c, a)});
  }
  return faces;
}

std::vector<std::pair<std::string, std::vector<int>>> MeshObject::patches(const Parameters& parameters) const {
  const MeshFile content = final_content(domain, result);
  SolverMesh made = all_of(*this, content);
  const auto support = certificate ? certificate->measured.domain.support : std::nullopt;
  MarkedFaces marked = marked_faces(made, content, support);
  mark_patches(domain, made, result.final, h, marked);
  divide_boundary(made, marked, domain.cloud, parameters, [](const std::string&) {});
  std::vector<std::pair<std::string, std::vector<int>>> named;
  for (const MeshPart& patch : made.patches) named.emplace_back(patch.name, std::vector<int>());
  for (std::size_t f = 0; f < made.n_faces(); ++f) {
    const std::array<int, 6> face = made.face(f);
    std::vector<int>& nodes = named[static_cast<std::size_t>(made.face_patch[f])].second;
    nodes.insert(nodes.end(), face.begin(), face.begin() + made.nodes_per_face());
  }
  return named;
}

void MeshObject::save(const std::filesystem::path& file) const {
  const std::string suffix = file.extension();
  const MeshFile content = final_content(domain, result);
  if (suffix == ".vtu" && second) return write_second_order(file, domain, result, content, *second);
  if (suffix == ".vtu") return write_vtu(file, content);
  if (suffix == ".msh") return write_msh41(file, for_solver(*this, content), MshEncoding::Binary);
  if (suffix == ".mesh") return write_medit(file, for_solver(*this, content));
  if (suffix == ".stl") {
    return write_surface(file, content.mesh.V, result.submesh.positive_faces, SurfaceFormat::Stl);
  }
  throw std::invalid_argument(file.string() + ": unknown suffix; use .vtu, .msh, .mesh or .stl");
}

}  // namespace umtet
