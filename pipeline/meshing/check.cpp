#include "pipeline/meshing/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "body/body.h"
#include "body/fidelity/closed_holes.h"
#include "body/fidelity/measure.h"
#include "body/sizing/edge_length.h"
#include "mesh/certify/boundary_surface.h"
#include "mesh/certify/certificate.h"
#include "mesh/io/file_regions.h"
#include "mesh/io/tet_mesh_io.h"
#include "mesh/regions/region_certificate.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/domain/load_domain.h"
#include "pipeline/reports/stage_reports.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

Domain domain_of_case(const fs::path& root) {
  const CasePaths paths{root};
  if (!fs::exists(paths.parameters())) throw UsageError(root.string() + " is not a case: it contains no case.toml");
  Parameters parameters;
  parameters.load(paths.parameters(), ParamSource::Case);
  return load_domain(paths, parameters);
}

/// Returns the boundary faces that lie in the sides of the box.
std::vector<Triangle> faces_at_walls(const TetMesh& mesh, const Box& box, double tolerance) {
  std::vector<Triangle> walls;
  for (const Triangle& f : boundary_faces(mesh.C, mesh.V.size()).triangles) {
    for (int side = 0; side < 6; ++side) {
      const int a = side / 2;
      const double at = side % 2 ? box.max()[a] : box.min()[a];
      const auto is_there = [&](int v) { return std::abs(mesh.V[v][a] - at) <= tolerance; };
      if (!std::all_of(f.begin(), f.end(), is_there)) continue;
      walls.push_back(f);
      break;
    }
  }
  return walls;
}

/// Returns the boundary without the faces at walls. Both lists have the same corners in the same order.
std::vector<Triangle> faces_but(std::vector<Triangle> walls, const TetMesh& mesh) {
  std::vector<Triangle> faces = boundary_faces(mesh.C, mesh.V.size()).triangles;
  std::sort(walls.begin(), walls.end());
  std::erase_if(faces, [&](const Triangle& f) { return std::binary_search(walls.begin(), walls.end(), f); });
  return faces;
}

SecondOrderReport check_second_order(const QuadraticTetMesh& mesh, const CertificateInput& corners,
                                     const std::optional<ImplicitFunctionRef>& psi, double h) {
  SecondOrderInput input;
  input.mesh = &mesh;
  input.h = h;
  input.psi = psi;
  input.wall_faces = corners.wall_faces;
  input.coordinate_rounding = corners.coordinate_rounding;
  input.context = corners.context;
  SecondOrderReport report{certify_second_order(input), {}};
  stop_if_interrupted();
  return report;
}

}  // namespace

MeshCheck check_mesh(const fs::path& file, const std::optional<fs::path>& against, const Parameters& parameters,
                     Progress& progress) {
  progress.report("check", "read", 0);
  MeshFile content = read_tet_mesh(file);
  TetMesh& mesh = content.mesh;
  if (mesh.C.empty()) throw MeshFileRefused(file, "the whole file", "it contains no tets");
  progress.detail(fmt::format("check: {} tets, {} vertices", mesh.C.size(), mesh.V.size()));
  CertificateInput input;
  input.mesh = &mesh;
  input.context = until_interrupted();
  std::optional<Domain> domain;
  std::vector<Triangle> walls;
  if (against) {
    domain.emplace(domain_of_case(*against));
    for (Vec3& x : mesh.V) x -= domain->shift;
    if (content.quadratic) {
      for (Vec3& x : content.quadratic->V) x -= domain->shift;
    }
    const StageState state = inspect_stage(CasePaths{*against}, Stage::Mesh, Json::object(), std::nullopt);
    // If the case has no mesh, it does not define h: the edge length of the checked mesh is the unit.
    if (state.record) {
      input.h = mesh_report(*state.record).measured.mesh.h;
      domain->limit_detail(input.h);
    }
    input.coordinate_rounding = coordinate_rounding(*domain);
    if (domain->complement) {
      walls = faces_at_walls(mesh, domain->box, 2 * input.coordinate_rounding);
      input.wall_faces = &walls;
      input.background_V = &mesh.V;  // the vertices are already at their final positions
    }
    progress.detail("check: against psi of " + against->string());
  }
  stop_if_interrupted();
  progress.report("check", "certify", .3);
  MeshCheck check;
  check.file = file.string();
  check.units = units_of(parameters);
  std::vector<std::string> of_regions;  // reasons to fail
  if (std::optional<FileRegions> regions = domain ? std::nullopt : file_regions(content)) {
    RegionCertificate certificate = certify_regions(mesh, regions->of_tet, nullptr, 0, input.context);
    check.mesh = certificate.whole;
    of_regions = failures(certificate, 0);
    check.regions = RegionCheck{std::move(*regions), std::move(certificate)};
  } else {
    check.mesh = domain ? certify_against(*domain, input) : certify(input);
  }
  stop_if_interrupted();
  MeshMeasures measured = measures_of(check.mesh, domain ? &*domain : nullptr, until_interrupted());
  if (content.quadratic) {
    const auto psi = domain ? std::optional(domain->psi()) : std::nullopt;
    check.second_order = check_second_order(*content.quadratic, input, psi, check.mesh.h);
    for (std::string& reason : failures(*check.second_order)) measured.reasons.push_back(std::move(reason));
  }
  for (std::string& reason : of_regions) {
    if (std::find(measured.reasons.begin(), measured.reasons.end(), reason) == measured.reasons.end())
      measured.reasons.push_back(std::move(reason));
  }
  check.is_valid = measured.is_valid;
  if (domain) check.defects = measured.defects;
  if (domain && domain->has_samples()) {
    check.support = support_report(*domain, mesh.V, faces_but(walls, mesh), until_interrupted());
  }
  check.verdict = judge(measured, parameters.output());
  return check;
}

}  // namespace umtet
