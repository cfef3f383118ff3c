#include <fmt/format.h>

#include <chrono>

#include "mesh/quality_report.h"
#include "mesh/tet_mesh_io.h"
#include "mesh/universal_mesh.h"
#include "pipeline/domain.h"
#include "pipeline/edge_length.h"
#include "pipeline/exit_code.h"
#include "pipeline/interrupt.h"
#include "pipeline/mesh_attempts.h"
#include "pipeline/mesh_measures.h"
#include "pipeline/stages.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

BackgroundMesh make_background(const Box& box, double h) {
  try {
    return BackgroundMesh(a15(), box, h);
  } catch (const std::invalid_argument& e) {  // h and the box have been checked: their tets are too many to count
    throw ResourceLimit(fmt::format("h = {:.4g}: no background mesh: {}", h, e.what()));
  }
}

class MeshStage {
 public:
  explicit MeshStage(const StageContext& context)
      : context_(context),
        domain_(load_domain(context.paths, context.parameters)),
        keep_iterates_(context.parameters.flag("mesh.keep_iterates")) {}

  void run();

 private:
  MeshAttempt attempt(double h);
  bool observe(const UmProgress& p);
  UmResult make(const ZeroSetChoice& pieces, double h);
  [[noreturn]] void refuse(const UmResult& result, double h);
  void write_iterate(const std::string& name, const UmResult& result, const std::vector<Vec3>& V);
  void write_outputs(const MeshAttempt& best);
  void begin();

  const StageContext& context_;
  const Domain domain_;
  const bool keep_iterates_;
  std::vector<std::vector<Vec3>> iterates_;  ///< of the running attempt
  std::vector<std::string> outputs_;
};

bool MeshStage::observe(const UmProgress& p) {
  const double n_rounds = static_cast<double>(context_.parameters.integer("mesh.projection_passes")) + 1;
  const std::string_view step = p.step;
  double rounds = 0;
  if (step == "project") rounds = p.pass - 1 + static_cast<double>(p.sweep) / std::max(p.n_sweeps, 1);
  if (step == "relax") rounds = n_rounds - 1 + static_cast<double>(p.pass) / std::max(p.n_passes, 1);
  if (keep_iterates_ && step == "project" && p.sweep == p.n_sweeps) iterates_.push_back(*p.V);
  return context_.progress.report("mesh", step, .1 + .8 * rounds / n_rounds);
}

UmResult MeshStage::make(const ZeroSetChoice& pieces, double h) {
  UmParams params = um_params(context_.parameters);
  // The full loop would mesh every piece; crawling starts from the ones to keep.
  if (!pieces.dropped.empty()) params.search = SubmeshSearch::Crawl;
  if (pieces.seeds.empty() && !pieces.dropped.empty()) {
    throw MeshingImpossible("psi = 0 is nowhere near the samples:\n  no " + pieces.dropped.front());
  }
  const BackgroundMesh background = make_background(domain_.box, h);
  context_.progress.detail(fmt::format("mesh: h = {:.6g}, background of {} tets, psi = 0 in {} pieces", h,
                                       background.n_tets(), pieces.topology.components.size()));
  return universal_mesh(
      background, domain_.psi(), params, [this](const UmProgress& p) { return observe(p); }, pieces.seeds);
}

void MeshStage::begin() {
  begin_writing(context_, Stage::Mesh);
  // An older mesh would stand beside parameters that did not make it.
  for (const char* name : {"omega_h.vtu", "projected.vtu", "mesh.vtu", "quality.csv"}) {
    fs::remove(context_.paths.folder(Stage::Mesh) / name);
  }
  for (int pass = 1; fs::remove(context_.paths.folder(Stage::Mesh) / fmt::format("pass_{}.vtu", pass)); ++pass) {
  }
}

void MeshStage::write_iterate(const std::string& name, const UmResult& result, const std::vector<Vec3>& V) {
  TetMesh mesh{V, result.submesh.mesh.C};
  for (Vec3& x : mesh.V) x += domain_.shift;
  const MeshFile file =
      with_standard_data(std::move(mesh), result.submesh.background_vertex, result.submesh.background_tet);
  write_artefact(context_.paths.folder(Stage::Mesh) / name,
                 [&](const fs::path& temporary) { write_vtu(temporary, file); });
  outputs_.push_back(name);
}

void MeshStage::refuse(const UmResult& result, double h) {
  begin();
  const std::size_t n = result.submesh.mesh.V.size();
  if (n > 0) write_iterate("omega_h.vtu", result, result.submesh.mesh.V);
  const std::vector<Vec3>& last = result.final.size() == n ? result.final : result.projected;
  if (n > 0 && last.size() == n) write_iterate("projected.vtu", result, last);
  const UmEvidence& e = result.evidence;
  const Vec3 at = e.where + domain_.shift;
  std::string message = fmt::format("no mesh at h = {:.6g}: {}: {}", h, to_string(result.status), e.what);
  if (e.background_vertex >= 0 || e.background_tet >= 0) {
    message += fmt::format("\n  at ({:.9g}, {:.9g}, {:.9g})", at.x(), at.y(), at.z());
    if (e.background_vertex >= 0) message += fmt::format(", background vertex {}", e.background_vertex);
    if (e.background_tet >= 0) message += fmt::format(", background tet {}", e.background_tet);
    if (e.count > 1) message += fmt::format(" (the first of {})", e.count);
  }
  if (!outputs_.empty()) {
    message += "\n  look at omega_h.vtu and projected.vtu (the last iterate) in " +
               context_.paths.folder(Stage::Mesh).string();
  }
  throw MeshingImpossible(message);
}

MeshAttempt MeshStage::attempt(double h) {
  MeshAttempt a;
  a.h = h;
  iterates_.clear();
  stop_if_interrupted();
  context_.progress.report("mesh", "components", .05);
  const ZeroSetChoice pieces = choose_components(domain_, h);
  for (const std::string& reason : pieces.dropped) context_.progress.say("mesh: left out a " + reason);
  stop_if_interrupted();
  a.result = make(pieces, h);
  a.iterates = std::move(iterates_);
  stop_if_interrupted();
  if (a.made()) {
    context_.progress.report("mesh", "certify", .9);
    a.measured = measure(domain_, a.result, pieces, h);
    stop_if_interrupted();
  }
  return a;
}

void MeshStage::run() {
  const auto start = std::chrono::steady_clock::now();
  const std::vector<RecordedFile> inputs = recorded_inputs(context_.paths, Stage::Mesh, context_.parameters);
  context_.progress.report("mesh", "size", 0);
  const MeshAttempt best = best_attempt(
      choose_edge_length(domain_, context_.parameters), [this](double h) { return attempt(h); },
      [this](const std::string& line) { context_.progress.say(line); });
  const UmResult& result = best.result;
  if (!best.made()) refuse(result, best.h);

  context_.progress.report("mesh", "write", .97);
  write_outputs(best);
  const Json numbers = {{"conditioning_angle_max_deg", result.conditioning_angle_max_deg},
                        {"n_psi_evaluations", result.n_psi_evaluations},
                        {"measured", best.measured}};
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  write_record(context_.paths,
               {Stage::Mesh,
                context_.parameters.section("mesh"),
                inputs,
                {},
                numbers,
                run_block(seconds.count(), context_.threads)},
               outputs_);
}

void MeshStage::write_outputs(const MeshAttempt& best) {
  begin();
  const UmResult& result = best.result;
  const std::vector<Vec3>& omega_h = result.submesh.mesh.V;
  write_iterate("omega_h.vtu", result, omega_h);
  for (std::size_t k = 0; k < best.iterates.size(); ++k)
    write_iterate(fmt::format("pass_{}.vtu", k + 1), result, best.iterates[k]);
  write_iterate("projected.vtu", result, result.projected);
  write_iterate("mesh.vtu", result, result.final);
  write_artefact(context_.paths.folder(Stage::Mesh) / "quality.csv", [&](const fs::path& temporary) {
    write_quality_csv(temporary, quality_curves(result.submesh.mesh.C, result.submesh.positive_vertices, omega_h,
                                                result.projected, result.final));
  });
  outputs_.push_back("quality.csv");
}

}  // namespace

UmParams um_params(const Parameters& p) {
  UmParams um;
  um.projection_passes = static_cast<int>(p.integer("mesh.projection_passes"));
  um.relaxation_iterations = static_cast<int>(p.integer("mesh.relaxation_iterations"));
  um.samples = static_cast<int>(p.integer("mesh.samples"));
  um.directions = p.text("mesh.directions") == "axes" ? DirectionRule::AxesInTurn : DirectionRule::Random;
  const std::string& projection = p.text("mesh.closest_point");
  um.closest_point.method = projection == "paper"    ? ClosestPointMethod::Paper
                            : projection == "damped" ? ClosestPointMethod::Damped
                                                     : ClosestPointMethod::Newton;
  um.max_min = p.text("mesh.max_min") == "golden" ? MaxMin::GoldenSection : MaxMin::Exact;
  um.seed = static_cast<std::uint64_t>(p.integer("mesh.seed"));
  std::string broken;
  for (const std::string& problem : problems(um)) broken += (broken.empty() ? "mesh: " : "; ") + problem;
  if (!broken.empty()) throw UsageError(broken);
  return um;
}

void run_mesh_stage(const StageContext& context) { MeshStage(context).run(); }

}  // namespace umtet
