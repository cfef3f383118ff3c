#include "pipeline/run/regions.h"

#include <fmt/format.h>

#include <fstream>
#include <memory>
#include <utility>

#include "body/errors.h"
#include "body/regions/label_regions.h"
#include "body/regions/region_bodies.h"
#include "mesh/expression/expression.h"
#include "mesh/io/solver_mesh.h"
#include "mesh/io/tet_mesh_io.h"
#include "pipeline/case/artefact.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/case/label_names.h"
#include "pipeline/domain/load_domain.h"
#include "pipeline/output/export_case.h"
#include "pipeline/reports/region_json.h"
#include "pipeline/reports/region_lines.h"
#include "pipeline/run/run.h"
#include "reconstruct/io/grid_io.h"

namespace umtet {
namespace {

namespace fs = std::filesystem;

RegionBody body_of_formula(const NamedSource& body) {
  const auto f = std::make_shared<const Expression>(body.source);
  return {.name = body.name,
          .psi = [f](const Vec3& x, Vec3* gradient, Mat3* hessian) { return f->evaluate(x, gradient, hessian); }};
}

/// Fits psi of a file in a case of its own.
RegionBody body_of_file(const NamedSource& body, const RegionsRequest& request, Progress& progress) {
  RunRequest run;
  run.case_folder = request.folder / "bodies" / body.name;
  run.source = body.source;
  run.parameters = request.parameters;
  run.parameters.set(keys::cloud::file, body.source, ParamSource::Flag, body.name);
  // One function for each body: its sharp edges are rounded.
  run.parameters.set(keys::reconstruct::edges, "off", ParamSource::Flag, "umtet regions");
  run.until = Stage::LevelSet;
  run.report = false;
  run.threads = request.threads;
  run_case(run, progress);
  const auto domain = std::make_shared<const Domain>(load_domain(CasePaths{run.case_folder}, run.parameters));
  RegionBody made{.name = body.name, .psi = [domain](const Vec3& x, Vec3* gradient, Mat3* hessian) {
                    return domain->evaluate(x - domain->shift, gradient, hessian);
                  }};
  Box box;
  for (const Vec3& x : domain->cloud.points) {
    made.samples.push_back(x + domain->shift);
    box.extend(made.samples.back());
  }
  made.box = box;
  return made;
}

/// \throw GridRefused  an image without labels
RegionBodyMesh mesh_image(const RegionsRequest& request, const RegionBodyOptions& options) {
  const Grid grid = read_grid(request.image);
  if (kind_of(grid) != GridKind::Segmentation)
    throw GridRefused(request.image.string() + ": this is no segmentation: its values are not the numbers of parts");
  return mesh_label_regions(grid, parse_label_names(request.parameters.output().label_names), options);
}

RegionBodyMesh mesh_bodies(const RegionsRequest& request, const RegionBodyOptions& options, Progress& progress) {
  std::vector<RegionBody> bodies;
  bodies.reserve(request.bodies.size());
  for (const NamedSource& body : request.bodies)
    bodies.push_back(is_file(body.source) ? body_of_file(body, request, progress) : body_of_formula(body));
  return mesh_region_bodies(bodies, options, request.overlap);
}

std::string summary_of(const RegionBodyMesh& made) {
  std::string text = region_lines(made.certificate, made.names, true);
  for (const MissedBodySamples& m : made.missed)
    text += fmt::format("samples of {}: {} on its visible part, the farthest {:.2g} h from a vertex\n",
                        made.names[m.region], m.n_visible, m.farthest / made.h);
  if (made.match)
    text += fmt::format("opposite sides: {} pairs of vertices, {} faces match, {} are surfaces of bodies\n",
                        made.match->n_pairs, made.match->sides.size(), made.match->n_unmatched);
  for (const RegionVoxels& r : made.voxels)
    text += fmt::format("voxels of {}: volume {:.6g}, {:+.2f} % in the mesh\n", made.names[r.region],
                        r.volume_of_voxels, 100 * (r.volume / r.volume_of_voxels - 1));
  if (made.reasons.empty())
    return text + fmt::format("verdict: pass (valid, fits psi{}{})\n", made.missed.empty() ? "" : ", fits the samples",
                              made.voxels.empty() ? "" : ", fits the voxels");
  text += "verdict: fail\n";
  for (const std::string& reason : made.reasons) text += "  " + reason + "\n";
  return text;
}

/// Numbers of vertices, from 0, and how many periods the copy is away.
void write_pairs(const fs::path& path, const std::vector<PeriodicPair>& pairs) {
  std::ofstream out(path);
  out << "vertex,copy,x,y,z\n";
  for (const PeriodicPair& p : pairs)
    out << fmt::format("{},{},{},{},{}\n", p.vertex, p.copy, p.periods[0], p.periods[1], p.periods[2]);
}

}  // namespace

bool is_file(const std::string& source) {
  std::error_code ignored;  // a formula may be too long for the name of a file
  return fs::exists(source, ignored);
}

NamedSource named_source(const std::string& text) {
  const std::size_t at = text.find('=');
  if (at == std::string::npos || at + 1 == text.size())
    throw UsageError(
        fmt::format("regions: {}: write NAME=FORMULA or NAME=FILE, or the path of an image of labels", text));
  NamedSource body{text.substr(0, at), text.substr(at + 1)};
  if (const std::string problem = problem_of_region_name(body.name); !problem.empty())
    throw UsageError(fmt::format("regions: {}: {}", body.name, problem));
  return body;
}

RegionsOutcome mesh_regions(const RegionsRequest& request, Progress& progress) {
  RegionBodyOptions options{.h = request.parameters.mesh().h,
                            .tets = request.parameters.mesh().tets,
                            .box = parse_box(request.parameters.mesh().box),
                            .has_outside = request.has_outside,
                            .is_periodic = request.is_periodic,
                            .context = until_interrupted()};
  options.context.progress = [&](const char* step, double fraction) { progress.report("regions", step, fraction); };
  const RegionBodyMesh made =
      request.image.empty() ? mesh_bodies(request, options, progress) : mesh_image(request, options);

  RegionsOutcome outcome;
  outcome.document = document_of_regions(made);
  outcome.text = summary_of(made);
  outcome.code = made.reasons.empty() ? ExitCode::Success : ExitCode::GateFailed;
  MeshFile file = with_standard_data(made.mesh.mesh, made.mesh.background_vertex, made.mesh.background_tet);
  file.cell_data["region"] = std::vector<std::int64_t>(made.mesh.region.begin(), made.mesh.region.end());
  for (std::size_t r = 0; r < made.names.size(); ++r) file.region_names[static_cast<std::int64_t>(r)] = made.names[r];
  fs::create_directories(request.folder);
  outcome.files = {request.folder / "regions.vtu", request.folder / "regions.json"};
  for (const fs::path& former : exported_files(CasePaths{request.folder})) fs::remove(former);
  write_artefact(outcome.files[0], [&](const fs::path& path) { write_vtu(path, file); });
  write_artefact(outcome.files[1], [&](const fs::path& path) {
    std::ofstream out(path);
    out << outcome.document.dump(2) << '\n';
  });
  if (made.match) {
    outcome.files.push_back(request.folder / "periodic.csv");
    write_artefact(outcome.files.back(), [&](const fs::path& path) { write_pairs(path, made.pairs); });
  } else {
    fs::remove(request.folder / "periodic.csv");  // of a former mesh
  }
  return outcome;
}

}  // namespace umtet
