#include "pipeline/meshing/check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "mesh/certify/boundary_surface.h"
#include "mesh/certify/certificate.h"
#include "mesh/io/tet_mesh_io.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/case/version.h"
#include "pipeline/meshing/domain.h"
#include "pipeline/meshing/edge_length.h"
#include "pipeline/meshing/mesh_measures.h"
#include "pipeline/meshing/second_order.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

Domain domain_of_case(const fs::path& root) {
  const CasePaths paths{root};
  if (!fs::exists(paths.parameters())) throw UsageError(root.string() + " is not a case: it has no case.toml");
  Parameters parameters;
  parameters.load(paths.parameters(), ParamSource::Case);
  return load_domain(paths, parameters);
}

/// Faces of the boundary in the sides of the box.
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

Json check_second_order(const QuadraticTetMesh& mesh, const CertificateInput& corners, double h,
                        std::vector<std::string>& reasons) {
  SecondOrderInput input;
  input.mesh = &mesh;
  input.h = h;
  input.psi = corners.psi;
  input.wall_faces = corners.wall_faces;
  input.coordinate_rounding = corners.coordinate_rounding;
  input.context = corners.context;
  const SecondOrderCertificate certificate = certify_second_order(input);
  for (const std::string& reason : failures(certificate)) reasons.push_back(reason);
  stop_if_interrupted();
  return to_json(certificate);
}

}  // namespace

Json check_mesh(const fs::path& file, const std::optional<fs::path>& against, const Parameters& parameters,
                Progress& progress) {
  progress.report("check", "read", 0);
  MeshFile content = read_tet_mesh(file);
  TetMesh& mesh = content.mesh;
  if (mesh.C.empty()) throw MeshFileRefused(file, "the whole file", "it has no tets");
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
    // Without a mesh of its own the case says nothing about h: the mesh's own edge length is the unit then.
    if (state.record) {
      input.h = state.record->numbers.at("measured").value("h", 0.);
      domain->limit_detail(input.h);
    }
    input.psi = domain->psi();
    input.coordinate_rounding = coordinate_rounding(*domain);
    if (domain->complement) {
      walls = faces_at_walls(mesh, domain->box, 2 * input.coordinate_rounding);
      input.wall_faces = &walls;
      input.background_V = &mesh.V;  // where they are is where they are to be
    }
    progress.detail("check: against psi of " + against->string());
  }
  stop_if_interrupted();
  progress.report("check", "certify", .3);
  const MeshCertificate certificate = certify(input);
  std::vector<std::string> reasons = failures(certificate);
  stop_if_interrupted();
  Json second = nullptr;
  if (content.quadratic) second = check_second_order(*content.quadratic, input, certificate.h, reasons);
  const double min_quality = parameters.output().min_quality;
  if (min_quality > 0 && certificate.quality.min < min_quality) {
    reasons.push_back(
        fmt::format("min quality {:.4f} is below the gate of {:.4f}", certificate.quality.min, min_quality));
  }
  Json json = {{"schema", 1}, {"tool", "umtet"}, {"version", kVersion}, {"mesh", file.string()}};
  const std::string& units = parameters.output().units;
  json["units"] = units.empty() ? Json(nullptr) : Json(units);
  json.update(to_json(certificate));
  json["order"] = content.quadratic ? 2 : 1;
  json["second_order"] = second;
  json["verdict"] = reasons.empty() ? "pass" : "fail";
  json["reasons"] = reasons;
  return json;
}

}  // namespace umtet
