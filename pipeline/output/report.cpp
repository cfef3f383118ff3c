#include "pipeline/output/report.h"

#include <fmt/format.h>
#include <oneapi/tbb/parallel_invoke.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <sstream>

#include "pipeline/case/exit_code.h"
#include "pipeline/case/failure_file.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/domain/load_domain.h"
#include "pipeline/output/boundary_patches.h"
#include "pipeline/output/report_defects.h"
#include "pipeline/output/report_page.h"
#include "pipeline/output/report_plot.h"
#include "pipeline/output/report_scene.h"
#include "pipeline/output/stage_strip.h"
#include "pipeline/reports/certificate_json.h"
#include "pipeline/reports/stage_reports.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

constexpr int kAngleBins = 90, kQualityBins = 100;
constexpr double kDegrees = 57.29577951308232;
// Maximum number of tets whose angles are computed: for all tets of a large mesh this would take as long as the rest of
// the report.
constexpr std::size_t kAngleTets = 200'000;
// Bytes at the beginning of the page that contain its sources: names of labels may take some thousand.
constexpr std::size_t kHead = 100'000;

/// Returns the shares of the six dihedral angles in percent, in bins from 0 to 180 degrees, for one tet in `step`.
std::vector<double> angle_shares(const TetMesh& mesh, std::size_t step) {
  std::vector<double> share(kAngleBins, 0);
  for (std::size_t at = 0; at < mesh.C.size(); at += step) {
    const Tet& t = mesh.C[at];
    std::array<Vec3, 4> n;
    for (int k = 0; k < 4; ++k) {
      const Vec3& a = mesh.V[t[kTetFace[k][0]]];
      n[k] = (mesh.V[t[kTetFace[k][1]]] - a).cross(mesh.V[t[kTetFace[k][2]]] - a);
      n[k] /= n[k].norm();
    }
    for (int i = 0; i < 3; ++i) {
      for (int j = i + 1; j < 4; ++j) {
        const double degrees = kDegrees * std::acos(std::clamp(-n[i].dot(n[j]), -1., 1.));
        ++share[std::min(kAngleBins - 1, static_cast<int>(degrees * kAngleBins / 180))];
      }
    }
  }
  const std::size_t n = (mesh.C.size() + step - 1) / step;
  for (double& s : share) s *= 100 / (6 * static_cast<double>(n));
  return share;
}

std::string angle_plot(const TetMesh& mesh) {
  const std::size_t step = mesh.C.size() / kAngleTets + 1;
  const std::string title =
      step == 1 ? "Dihedral angles of all tets" : fmt::format("Dihedral angles of one tet in {}", step);
  return line_plot({title, "degrees", "share, %", false, false},
                   {{"", "c0", histogram_outline(angle_shares(mesh, step), 0, 180)}});
}

/// Returns the numbers of tets by mean ratio, in bins from 0 to 1.
std::vector<double> quality_counts(const MeshFile& mesh) {
  std::vector<double> count(kQualityBins, 0);
  for (const double q : std::get<std::vector<double>>(mesh.cell_data.at("mean_ratio")))
    ++count[std::clamp(static_cast<int>(q * kQualityBins), 0, kQualityBins - 1)];
  return count;
}

/// Returns the columns of quality.csv after the first, which is the x of all curves.
std::vector<PlotCurve> quality_curves_of(const fs::path& file) {
  // Solid: all vertices; dashed: vertices of tets at the boundary.
  std::vector<PlotCurve> curves = {{"cut out of the background", "c0", {}},
                                   {"projected on ψ = 0", "c1", {}},
                                   {"final mesh", "c2", {}},
                                   {"", "c0 dashed", {}},
                                   {"", "c1 dashed", {}},
                                   {"dashed: at the boundary", "c2 dashed", {}}};
  std::istringstream in(read_text(file));
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::istringstream cells(line);
    std::string cell;
    std::getline(cells, cell, ',');
    const double index = std::stod(cell);
    for (PlotCurve& c : curves) {
      if (std::getline(cells, cell, ',') && !cell.empty()) c.points.push_back({index, std::stod(cell)});
    }
  }
  return curves;
}

std::string residual_plot(const std::vector<double>& residuals) {
  PlotCurve curve{"", "c0", {}};
  for (const double r : residuals) curve.points.push_back({static_cast<double>(curve.points.size()), r});
  return line_plot({"Fit of ψ on the coarsest lattice", "iteration", "relative residual", false, true}, {curve});
}

std::string shown_text(const SceneHead& scene) {
  const auto part = [](std::size_t shown, std::size_t all, const char* what) {
    return shown == all ? fmt::format("all {} {}", all, what) : fmt::format("{} of {} {}", shown, all, what);
  };
  std::string text = "In this file: " + part(scene.n_faces_shown, scene.n_faces, "boundary faces") + ", " +
                     part(scene.n_tets_shown, scene.n_tets, "tets");
  if (scene.n_points != 0) text += ", " + part(scene.n_points_shown, scene.n_points, "samples");
  text += ".";
  if (scene.n_faces != scene.n_faces_shown) text += " The surface is coarsened for the view.";
  if (scene.planes) text += " Only the worst tets and the tets at the middle planes of the box are shown.";
  return text +
         " Positions are rounded to 1/65535 of the box, colours to 1/255 of their range. Deviation is |ψ| / |∇ψ|.";
}

std::string title_of(const CasePaths& paths) {
  const fs::path root = fs::absolute(paths.root).lexically_normal();
  const fs::path name = root.has_filename() ? root.filename() : root.parent_path().filename();
  return html_text(name.string());
}

/// Reads mesh.vtu, and psi as it was meshed. \throw ArtefactDamaged, std::system_error
Handover read_back(const CasePaths& paths, const Parameters& parameters, double h) {
  Handover read;
  read.domain = load_domain(paths, parameters);
  read.domain->limit_detail(h);
  try {
    read.mesh = read_tet_mesh(paths.mesh());
  } catch (const MeshFileRefused& e) {
    throw ArtefactDamaged(e.what());
  }
  return read;
}

struct Figures {
  std::string figures, tables;
};

Figures figures_of(const CasePaths& paths, const Parameters& parameters, const MeshFile& mesh,
                   const Certificate& certificate) {
  const bool of_cloud = !has_own_psi(parameters.mesh());
  std::vector<StageRecord> records;
  if (of_cloud) records = {read_record(paths, Stage::Cloud), read_record(paths, Stage::LevelSet)};
  records.push_back(read_record(paths, Stage::Mesh));
  SsdReport fit;
  if (of_cloud) fit = level_set_report(records[1]).fit;
  Figures f;
  f.figures = line_plot({"Quality vectors of the three stages", "index of the vertex, worst first",
                         "least mean ratio Q around it", true, false},
                        quality_curves_of(paths.folder(Stage::Mesh) / "quality.csv"));
  f.figures += angle_plot(mesh.mesh);
  f.figures += line_plot({"Mean ratio of the tets", "mean ratio Q", "tets", false, true},
                         {{"", "c2", histogram_outline(quality_counts(mesh), 0, 1)}});
  if (of_cloud) f.figures += residual_plot(fit.residuals);
  f.tables = stage_table(records);
  if (of_cloud) f.tables += band_table(fit.bands);
  f.tables += parameter_table(read_text(paths.parameters())) + certificate_table(to_json(certificate));
  return f;
}

/// Returns the mesh with the patches of exported files.
SolverMesh divided(const CasePaths& paths, const MeshFile& mesh, const Domain& domain, const Parameters& parameters,
                   const MeshMeasures& measured) {
  SolverMesh made = solver_mesh(mesh.mesh);
  for (Vec3& x : made.nodes) x -= domain.shift;
  MarkedFaces marked = marked_faces(made, mesh, measured.domain.support);
  mark_patches(domain, made, made.nodes, measured.mesh.h, marked);
  try {
    divide_boundary(
        made, marked, domain.cloud, parameters, [](const std::string&) {}, label_names_of_file(paths));
  } catch (const UsageError&) {
    // An export refuses names for labels that do not exist; here all faces then stay one patch.
  }
  return made;
}

/// Returns the settings that patches depend on besides the mesh.
std::string patch_settings(const Parameters& parameters) {
  return html_text(fmt::format("{} {} {} {}", parameters.output().label_names, parameters.output().label_min_area,
                               parameters.output().patch_angle, parameters.output().patch_planar));
}

/// Returns why there is no mesh, and the stage to blame.
std::string failure_list(const std::optional<CaseFailure>& failure, const Json& blame) {
  if (!failure) return "<ul class=\"reasons\">\n<li>There is no mesh yet: umtet run continues the case.</li>\n</ul>";
  std::string out = fmt::format(
      "<ul class=\"reasons\">\n<li>The stage {} ended with exit code {}: <span class=\"said\">{}"
      "</span></li>\n",
      to_string(failure->stage), static_cast<int>(failure->code), html_text(failure->message));
  if (blame.is_object()) {
    const std::string remedy = blame.at("remedy");
    out += "<li>Cause: " + html_text(blame.at("stage")) + " (" + html_text(blame.at("number")) + ")." +
           (remedy.empty() ? "" : " Try " + html_text(remedy) + ".") + "</li>\n";
  }
  return out + "</ul>";
}

CertificateRun run_of(const Certificate& certificate) { return certificate.run.value_or(CertificateRun{}); }

}  // namespace

void write_report(const CasePaths& paths, const Parameters& parameters, const Certificate& certificate,
                  const Handover& handover) {
  if (!handover.domain) {
    return write_report(paths, parameters, certificate, read_back(paths, parameters, certificate.measured.mesh.h));
  }
  stop_if_interrupted();
  const MeshFile& mesh = handover.mesh;
  ReportScene scene;
  Figures figures;
  StageStrip strip;
  tbb::parallel_invoke(
      [&] {
        scene = report_scene(mesh, *handover.domain,
                             divided(paths, mesh, *handover.domain, parameters, certificate.measured));
      },
      [&] { figures = figures_of(paths, parameters, mesh, certificate); },
      [&] {
        strip = stage_strip({paths, parameters, &*handover.domain, &certificate});
      });
  stop_if_interrupted();
  std::erase_if(scene.blocks, [](const auto& block) { return block.first == "points"; });  // a layer of the strip
  const CertificateRun run = run_of(certificate);
  write_text_artefact(paths.report(),
                      report_page({{"checksum", run.checksum},
                                   {"patch_settings", patch_settings(parameters)},
                                   {"title", title_of(paths)},
                                   {"verdict", certificate.verdict.word()},
                                   {"verdict_mark", " data-certificate=\"/verdict\""},
                                   {"made", html_text(fmt::format("umtet {} · {}", certificate.version, run.date))},
                                   {"reasons", reason_list(certificate)},
                                   {"checks", check_list(certificate)},
                                   {"cards", headline_cards(certificate)},
                                   {"shown", shown_text(scene.head)},
                                   {"places", defect_table(certificate)},
                                   {"holes", hole_table(certificate)},
                                   {"missed", missed_table(certificate)},
                                   {"figures", figures.figures},
                                   {"tables", figures.tables},
                                   {"certificate", script_json(to_json(certificate))},
                                   {"scene", script_json(to_json(scene.head))},
                                   {"strip", script_json(strip.document)},
                                   {"blocks", blocks_text(scene.blocks) + blocks_text(strip.blocks)}}));
}

void write_unfinished_report(const CasePaths& paths, const Parameters& parameters) {
  std::optional<Domain> domain;
  std::vector<StageRecord> records;
  const bool is_alone = has_own_psi(parameters.mesh());
  for (const Stage stage : kStages) {
    if (!is_alone && fs::exists(paths.record(stage))) records.push_back(read_record(paths, stage));
  }
  if (is_alone || fs::exists(paths.record(Stage::LevelSet))) domain = load_domain(paths, parameters);
  const std::optional<CaseFailure> failure = read_failure(paths);
  const StageStrip strip = stage_strip({paths, parameters, domain ? &*domain : nullptr, nullptr, failure});
  stop_if_interrupted();
  write_text_artefact(paths.report(),
                      report_page({{"title", title_of(paths)},
                                   {"verdict", failure ? "fail" : "not finished"},
                                   {"made", html_text(fmt::format("umtet {}", kVersion))},
                                   {"reasons", failure_list(failure, strip.document.at("blame"))},
                                   {"shown", "There is no mesh."},
                                   {"tables", stage_table(records) + parameter_table(read_text(paths.parameters()))},
                                   {"strip", script_json(strip.document)},
                                   {"blocks", blocks_text(strip.blocks)}}));
}

bool report_is_of(const CasePaths& paths, const Certificate& certificate, const Parameters& parameters) {
  const auto meta = [](const char* name, const std::string& content) {
    return fmt::format("name=\"umtet-{}\" content=\"{}\"", name, content);
  };
  std::ifstream in(paths.report(), std::ios::binary);
  std::string head(kHead, '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  return head.find(meta("certificate", run_of(certificate).checksum)) != std::string::npos &&
         head.find(meta("patches", patch_settings(parameters))) != std::string::npos;
}

void report_case(const CasePaths& paths) {
  const bool has_stage = fs::exists(paths.failed()) || std::any_of(kStages.begin(), kStages.end(), [&](Stage stage) {
                           return fs::exists(paths.record(stage));
                         });
  if (!fs::exists(paths.parameters()) || !has_stage)
    throw UsageError(paths.root.string() + ": there is no stage to report; umtet run makes one");
  Parameters parameters;
  parameters.load(paths.parameters(), ParamSource::Case);
  if (!fs::exists(paths.certificate())) return write_unfinished_report(paths, parameters);
  const bool is_alone = has_own_psi(parameters.mesh());
  for (const Stage stage : kStages) {
    if (is_alone && stage != Stage::Mesh) continue;
    const StageState state = inspect_stage(paths, stage, parameters.section(section_of(stage)), std::nullopt);
    if (!state.record) throw ArtefactDamaged(state.reason);
  }
  const Json document = Json::parse(read_text(paths.certificate()), nullptr, false);
  if (document.is_discarded() || !seal_holds(document)) {
    throw ArtefactDamaged(paths.certificate().string() + " does not match its own checksum; umtet run makes it again");
  }
  write_report(paths, parameters, certificate_from(document));
}

}  // namespace umtet
