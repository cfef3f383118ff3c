#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>

#include "body/body.h"
#include "body/search/mesh_maker.h"
#include "body/sizing/background_choice.h"
#include "body/sizing/edge_length.h"
#include "body/sizing/too_thin.h"
#include "mesh/universal_mesh.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/case/memory.h"
#include "pipeline/case/option_words.h"
#include "pipeline/domain/body_options.h"
#include "pipeline/domain/load_domain.h"
#include "pipeline/meshing/defect_files.h"
#include "pipeline/meshing/made_mesh.h"
#include "pipeline/reports/stage_reports.h"
#include "pipeline/stages/given_normals.h"
#include "pipeline/stages/mesh_outputs.h"
#include "pipeline/stages/stages.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

// Number of tets with a vertex that moves, per h^2 of boundary: 17 for a sphere of 50 thousand tets, 19 for a sphere
// and a torus of 500 thousand. The other meshes of a case contain only these tets.
constexpr double kMovingTets = 20;

class MeshStage {
 public:
  explicit MeshStage(const StageContext& context)
      : context_(context),
        domain_(load_domain(context.paths, context.parameters, &context.handover)),
        background_(body_options(context.parameters), domain_),
        maker_(domain_, body_options(context.parameters), call(), lines(), context.ranks) {}

  /// Returns the mesh of the best h. \throw MeshingImpossible  there is none
  MeshAttempt best_mesh();

  Domain& domain() { return domain_; }

 private:
  Context call() const;
  MeshLines lines() const;
  SizedBackground background_of(double h);
  EdgeLength enough_for(const ThinPlaces& thin);
  std::string remedy_for(const ThinPlaces& thin, std::optional<double>& h_enough);
  [[noreturn]] void refuse_thin(const MeshAttempt& best);
  [[noreturn]] void refuse(const UmResult& result, double h);
  const StageContext& context_;
  Domain domain_;
  BackgroundChoice background_;
  MeshMaker maker_;
};

Context MeshStage::call() const {
  return {.progress = [this](const char* step, double part) { context_.progress.report("mesh", step, part); },
          .cancelled = until_interrupted().cancelled};
}

MeshLines MeshStage::lines() const {
  return {.say = [this](const Message& line) { context_.progress.say("mesh: " + text_of(line, as_flag)); },
          .detail = [this](const std::string& line) { context_.progress.detail("mesh: " + line); }};
}

/// Makes the background and checks that the disk has room for its meshes.
SizedBackground MeshStage::background_of(double h) {
  stop_if_interrupted();
  const Parameters& p = context_.parameters;
  const double allowed = context_.ranks ? context_.ranks->allowed_bytes(p) : allowed_bytes(p);
  SizedBackground made = background_.make(domain_, h, p.mesh().tets, allowed, call());
  const double n = background_.expected_tets(domain_, h), n_moving = kMovingTets * domain_.size().area / (h * h);
  require_disk(context_.paths.root, p.mesh().keep_iterates ? n * static_cast<double>(3 + p.mesh().projection_passes)
                                                           : n + 2 * std::min(n, n_moving));
  return made;
}

void MeshStage::refuse(const UmResult& result, double h) {
  if (!context_.paths.renews(Stage::Mesh)) begin_writing(context_, Stage::Mesh);
  const fs::path folder = write_failed_mesh(context_.paths, domain_, result);
  const std::size_t n = result.submesh.mesh.V.size();
  std::string message = failure_text(result, h, domain_.shift);
  if (n > 0) message += "\n  see omega_h.vtu and projected.vtu (the last iterate) in " + folder.string();
  if (context_.paths.renews(Stage::Mesh)) message += "\n  the former mesh and its certificate are kept";
  throw MeshingImpossible(message);
}

// With a smaller h, psi contains more detail, which may be thinner still: h is reduced at most kThinRounds times, by a
// factor of at most kThinStep each time.
constexpr int kThinRounds = 8;
constexpr double kThinStep = .9;

/// Returns an h for which nothing is too thin, within the limit of --max-tets.
EdgeLength MeshStage::enough_for(const ThinPlaces& thin) {
  EdgeLength choice{thin.h, background_.least_h(domain_)};
  double needed = thin.h_needed();
  for (int round = 0; round < kThinRounds && choice.h > choice.least; ++round) {
    choice.h = std::max(std::min(needed, kThinStep * choice.h), choice.least);
    const ThinPlaces left = find_thin_places(domain_, maker_.pieces_at(choice.h), choice.h, until_interrupted());
    if (left.empty()) break;
    needed = left.h_needed();
  }
  return choice;
}

std::string MeshStage::remedy_for(const ThinPlaces& thin, std::optional<double>& h_enough) {
  if (background_.own_h()) return fmt::format("a background with edges of {:.3g} may show them", thin.h_needed());
  // A plate so thin that it contains no point of the grid on which bodies are measured.
  if (!(domain_.size().volume > 0)) return fmt::format("h = {:.3g} may show them", thin.h_needed());
  const EdgeLength enough = enough_for(thin);
  if (!(enough.h < thin.h && enough.h > enough.least)) {
    return fmt::format("that requires more than {} tets: increase --max-tets", context_.parameters.mesh().max_tets);
  }
  h_enough = enough.h;
  return fmt::format("h = {:.3g} is enough, about {:.2g} tets", enough.h, background_.expected_tets(domain_, enough.h));
}

/// Throws TooThin if no mesh is possible, and writes the thin places to too_thin.vtp: in 3-mesh, or in 3-mesh/failed if
/// a finished mesh is kept.
void MeshStage::refuse_thin(const MeshAttempt& best) {
  const ThinPlaces& thin = best.thin;
  const bool keeps = context_.paths.renews(Stage::Mesh);
  if (!keeps) begin_writing(context_, Stage::Mesh);
  const fs::path failed = write_failed_mesh(context_.paths, domain_, best.result);
  const fs::path folder = keeps ? failed : context_.paths.folder(Stage::Mesh);
  fs::create_directories(folder);
  const fs::path file = folder / "too_thin.vtp";
  write_thin_places(file, thin, domain_.shift);
  std::string message = too_thin_text(best, domain_.shift) + "\n  ";
  std::optional<double> h_enough;
  message += remedy_for(thin, h_enough) + "\n  see " + file.string();
  message += doubt_about_given_normals(context_.paths);
  if (keeps) message += "\n  the former mesh and its certificate are kept";
  throw TooThin(message, {in_model(thin, domain_.shift), thin.h, h_enough});
}

MeshAttempt MeshStage::best_mesh() {
  for (const std::string& notice : texts_of(domain_.notices, as_flag)) context_.progress.say("mesh: " + notice);
  context_.progress.report("mesh", "size", 0);
  const EdgeLength choice = background_.edge_length(domain_, until_interrupted());
  // The fit and the choice have already used all levels.
  if (domain_.fitted) domain_.fitted->put_aside_below(kLeastSpacing * choice.h);
  if (choice.of_thin_parts) {
    context_.progress.say(
        fmt::format("mesh: h = {:.4g}, so that the noise of the samples is {:.2g} h: thinner parts are not resolved "
                    "(--h decides)",
                    choice.h, *domain_.noise / choice.h));
  }
  if (const double n = background_.uniform_tets(); n > 0) {
    context_.progress.say(fmt::format(
        "mesh: graded, with edges of at least {:.4g}: a single h for the thin parts of this body would make about "
        "{:.2g} tets instead of {:.2g} (--background a15 uses a single h)",
        choice.h, n, background_.expected_tets(domain_, choice.h)));
  }
  MeshAttempt best = maker_.best(background_, choice, [this](double h) { return background_of(h); });
  stop_if_interrupted();
  if (best.fell_through()) refuse_thin(best);
  if (!best.made()) refuse(best.result, best.h);
  if (!best.is_right() && !best.thin.empty()) {
    context_.progress.warn("mesh: " + too_thin_text(best, domain_.shift) + doubt_about_given_normals(context_.paths));
  }
  return best;
}

}  // namespace

void run_mesh_stage(const StageContext& context) {
  MeshStage stage(context);
  const auto start = std::chrono::steady_clock::now();
  const std::vector<RecordedFile> inputs = recorded_inputs(context.paths, Stage::Mesh, context.parameters);
  MeshAttempt best = stage.best_mesh();
  context.progress.report("mesh", "write", .97);
  const std::vector<std::string> outputs = write_mesh_outputs(context, stage.domain(), best);
  const MeshReport report{best.result.conditioning_angle_max_deg, best.result.n_psi_evaluations, best.measured};
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  write_record(context.paths,
               {Stage::Mesh,
                context.parameters.section("mesh"),
                inputs,
                {},
                to_json(report),
                run_of_stage(seconds.count(), context.threads)},
               outputs);
  if (best.parts) return;  // no process has the whole mesh
  stage.domain().shift_level(best.measured.domain.level_shift, best.h);
  context.handover.domain = std::move(stage.domain());
}

}  // namespace umtet
