#include "pipeline/run/regions.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include "body/errors.h"
#include "body/option_names.h"
#include "mesh/background/a15_box.h"
#include "mesh/background/background_mesh.h"
#include "mesh/expression/expression.h"
#include "mesh/io/solver_mesh.h"
#include "mesh/io/tet_mesh_io.h"
#include "mesh/regions/region_certificate.h"
#include "mesh/regions/region_mesh.h"
#include "pipeline/case/artefact.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/case/option_words.h"
#include "pipeline/case/version.h"
#include "pipeline/reports/region_json.h"

namespace umtet {
namespace {

namespace fs = std::filesystem;

constexpr double kTets = 100000;  // where neither h nor a number of tets is given
// Points of a grid along each axis that estimate the volume of the bodies, to a per cent or two.
constexpr int kVolumeGrid = 60;

PatchFunction function_of(const std::string& formula) {
  return [f = std::make_shared<const Expression>(formula)](const Vec3& x, Vec3* gradient, Mat3* hessian) {
    return f->evaluate(x, gradient, hessian);
  };
}

/// The share of the box that belongs to bodies.
double share_of_bodies(const RegionDomain& domain, const Box& box) {
  int n = 0;
  for (int i = 0; i < kVolumeGrid; ++i)
    for (int j = 0; j < kVolumeGrid; ++j)
      for (int k = 0; k < kVolumeGrid; ++k) {
        const Vec3 at = (Vec3(i, j, k).array() + .5).matrix() / kVolumeGrid;
        n += domain.region(box.min() + at.cwiseProduct(box.sizes())) != 0;
      }
  return n / std::pow(kVolumeGrid, 3);
}

/// h, or the h with which the A15 tets of a volume have the requested number.
double edge_length(const RegionsRequest& request, const RegionDomain& domain, const Box& box) {
  const MeshOptions& mesh = request.parameters.mesh();
  if (mesh.h > 0) return mesh.h;
  const double n = mesh.tets > 0 ? static_cast<double>(mesh.tets) : kTets;
  const double volume = box.volume() * (request.has_outside ? 1 : share_of_bodies(domain, box));
  if (!(volume > 0)) throw MeshingImpossible("no body is in the box");
  return a15().mean_edge * std::cbrt(static_cast<double>(a15().tets.size()) * volume / n);
}

void require_names(const std::vector<NamedFormula>& bodies) {
  if (bodies.empty()) throw UsageError("regions: give bodies as NAME=FORMULA");
  std::set<std::string> names = {"outside"};
  for (const NamedFormula& body : bodies)
    if (!names.insert(body.name).second)
      throw UsageError(fmt::format("regions: {} is the name of another region", body.name));
}

std::string summary_of(const RegionCertificate& c, const std::vector<std::string>& names,
                       const std::vector<std::string>& reasons) {
  std::string text =
      fmt::format("{:<16} {:>10} {:>8} {:>8} {:>14} {:>7}\n", "region", "tets", "least Q", "1 % Q", "volume", "pieces");
  for (const RegionMeasures& m : c.regions)
    text += fmt::format("{:<16} {:>10} {:>8.3f} {:>8.3f} {:>14.6g} {:>7}\n", names[m.region], m.certificate.n_tets,
                        m.certificate.quality.min, m.certificate.quality.p01, m.certificate.volume, m.n_pieces);
  for (const InterfaceMeasures& m : c.interfaces)
    text += fmt::format("interface {}|{}: {} faces, vertices within {:.1g} h, face centres within {:.2g} h\n",
                        names[m.region], names[m.other], m.n_faces, m.max_vertex_distance, m.max_centroid_distance);
  if (reasons.empty()) return text + "verdict: pass (valid, fits psi)\n";
  text += "verdict: fail\n";
  for (const std::string& reason : reasons) text += "  " + reason + "\n";
  return text;
}

}  // namespace

NamedFormula named_formula(const std::string& text) {
  const std::size_t at = text.find('=');
  if (at == std::string::npos || at + 1 == text.size())
    throw UsageError(fmt::format("regions: {}: write NAME=FORMULA", text));
  NamedFormula body{text.substr(0, at), text.substr(at + 1)};
  if (const std::string problem = problem_of_name(body.name); !problem.empty())
    throw UsageError(fmt::format("regions: {}: {}", body.name, problem));
  return body;
}

RegionsOutcome mesh_regions(const RegionsRequest& request, Progress& progress) {
  require_names(request.bodies);
  const std::optional<Box> box = parse_box(request.parameters.mesh().box);
  if (!box) throw UsageError({"regions needs ", Setting(option::box, "x0,y0,z0,x1,y1,z1")});
  std::vector<PatchFunction> bodies;
  std::vector<std::string> names = {"outside"};
  for (const NamedFormula& body : request.bodies) {
    bodies.push_back(function_of(body.formula));
    names.push_back(body.name);
  }
  const RegionDomain domain = RegionDomain::of_bodies(std::move(bodies));
  const double h = edge_length(request, domain, *box);
  const BackgroundMesh background =
      request.has_outside ? BackgroundMesh(a15_box(*box, h)) : BackgroundMesh(a15(), *box, h);
  Context context = until_interrupted();
  context.progress = [&](const char* step, double fraction) { progress.report("regions", step, fraction); };
  const RegionMesh made = make_region_mesh(domain, background, {.has_outside = request.has_outside}, context);
  if (made.status == UmStatus::DomainLeavesBackground)
    throw MeshingImpossible("a body reaches the boundary of the box; give a box with three edges around the bodies");
  if (made.status != UmStatus::Success) throw MeshingImpossible(made.evidence.what);
  progress.report("regions", "certify", .9);
  const RegionCertificate certificate = certify_regions(made.mesh, made.region, &domain, background.h(), context);
  std::vector<std::string> reasons = failures(certificate, domain.n_regions());

  RegionsOutcome outcome;
  outcome.document = document_of_regions(certificate, made, names, reasons);
  outcome.text = summary_of(certificate, names, reasons);
  outcome.code = reasons.empty() ? ExitCode::Success : ExitCode::GateFailed;
  MeshFile file = with_standard_data(made.mesh, made.background_vertex, made.background_tet);
  file.cell_data["region"] = std::vector<std::int64_t>(made.region.begin(), made.region.end());
  fs::create_directories(request.folder);
  outcome.files = {request.folder / "regions.vtu", request.folder / "regions.json"};
  write_artefact(outcome.files[0], [&](const fs::path& path) { write_vtu(path, file); });
  write_artefact(outcome.files[1], [&](const fs::path& path) {
    std::ofstream out(path);
    out << outcome.document.dump(2) << '\n';
  });
  return outcome;
}

}  // namespace umtet
