#include "pipeline/meshing/made_mesh.h"

#include <fmt/format.h>

#include <numeric>
#include <utility>

#include "mesh/certify/quality_report.h"
#include "mesh/implicit/surface_distance.h"
#include "pipeline/case/artefact.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/meshing/sample_fields.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

constexpr double kNoSupport = -1;  // for vertices that are not on the boundary

const char* remedy(UmStatus status) {
  switch (status) {
    case UmStatus::EmptyDomain:
      return "a smaller --h, or a --box around the region where psi < 0, may find it";
    case UmStatus::PsiNotFinite:
      return "psi must have a value in the whole --box: a root, a logarithm or a quotient in it is undefined";
    case UmStatus::BoundaryNearWall:
      return "give a larger --box or a smaller --h: the body must be two edges away from the walls of the box";
    case UmStatus::DomainLeavesBackground:
      return "give a larger --box, with a margin of two edges around the domain";
    default:
      return "a smaller --h (or a larger --tets) resolves more of the shape";
  }
}

/// @param mesh  in working coordinates
MeshFile content_of(const Domain& domain, TetMesh mesh, std::vector<std::int64_t> background_vertex,
                    std::vector<std::int64_t> background_tet, const std::vector<Triangle>& walls) {
  for (Vec3& x : mesh.V) x += domain.shift;
  MeshFile content = with_standard_data(std::move(mesh), std::move(background_vertex), std::move(background_tet));
  if (!walls.empty()) {
    std::vector<std::uint8_t> wall(content.mesh.V.size(), 0);
    for (const Triangle& f : walls) {
      for (const int i : f) wall[i] = 1;
    }
    content.point_data[kAtWall] = std::move(wall);
  }
  return content;
}

}  // namespace

void set_support(const Domain& domain, const std::vector<Vec3>& V, const std::vector<int>& vertices,
                 std::vector<double>& support) {
  std::vector<Vec3> x;
  x.reserve(vertices.size());
  for (const int i : vertices) x.push_back(V[i]);
  const std::vector<double> d = distances_to_samples(domain.cloud.points, x, until_interrupted());
  for (std::size_t k = 0; k < d.size(); ++k) support[vertices[k]] = d[k];
}

MeshFile mesh_content(const Domain& domain, const UmResult& result, const std::vector<Vec3>& V) {
  const Submesh& made = result.submesh;
  return content_of(domain, {V, made.mesh.C}, made.background_vertex, made.background_tet, result.walls);
}

MeshFile taken_content(const Domain& domain, UmResult& result) {
  Submesh& made = result.submesh;
  return content_of(domain, std::move(made.mesh), std::move(made.background_vertex), std::move(made.background_tet),
                    result.walls);
}

void move_to(const Domain& domain, const std::vector<Vec3>& V, MeshFile& content) {
  for (std::size_t i = 0; i < V.size(); ++i) content.mesh.V[i] = V[i] + domain.shift;
  measure_mean_ratios(content.mesh, std::get<std::vector<double>>(content.cell_data.at("mean_ratio")));
}

void add_support(const Domain& domain, const UmResult& result, MeshFile& content) {
  if (!domain.has_samples()) return;
  std::vector<double> support(result.final.size(), kNoSupport);
  set_support(domain, result.final, result.submesh.positive_vertices, support);
  content.point_data["support"] = std::move(support);
  set_sample_fields(domain, result.final, result.submesh.positive_vertices, content.point_data);
}

BoundaryData boundary_data(const Domain& domain, const UmResult& result, const std::vector<Vec3>& mid_sides) {
  MeshFile content;
  UmResult boundary;  // the whole boundary, and nothing else
  boundary.final = result.final;
  boundary.final.insert(boundary.final.end(), mid_sides.begin(), mid_sides.end());
  boundary.submesh.positive_vertices.resize(boundary.final.size());
  std::iota(boundary.submesh.positive_vertices.begin(), boundary.submesh.positive_vertices.end(), 0);
  add_support(domain, boundary, content);
  BoundaryData data{result.submesh.background_vertex, {}};
  for (auto& [name, values] : content.point_data)
    data.arrays.push_back({name, std::move(values), name == "support" ? kNoSupport : kNoSample});
  return data;
}

MeshFile final_content(const Domain& domain, const UmResult& result) {
  MeshFile content = mesh_content(domain, result, result.final);
  add_support(domain, result, content);
  return content;
}

void write_mesh(const fs::path& file, const MeshFile& content) {
  write_artefact(file, [&](const fs::path& temporary) { write_vtu(temporary, content); });
}

std::string failure_text(const UmResult& result, double h, const Vec3& shift) {
  const UmEvidence& e = result.evidence;
  const Vec3 at = e.where + shift;
  std::string message = fmt::format("no mesh at h = {:.6g}: {}: {}", h, to_string(result.status), e.what);
  if (e.background_vertex >= 0 || e.background_tet >= 0) {
    message += fmt::format("\n  at ({:.9g}, {:.9g}, {:.9g})", at.x(), at.y(), at.z());
    if (e.background_vertex >= 0) message += fmt::format(", background vertex {}", e.background_vertex);
    if (e.background_tet >= 0) message += fmt::format(", background tet {}", e.background_tet);
    if (e.count > 1) message += fmt::format(" (the first of {})", e.count);
  }
  return message + "\n  " + remedy(result.status);
}

}  // namespace umtet
