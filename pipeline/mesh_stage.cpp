#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "mesh/universal_mesh.h"
#include "pipeline/background_choice.h"
#include "pipeline/domain.h"
#include "pipeline/edge_length.h"
#include "pipeline/exit_code.h"
#include "pipeline/interrupt.h"
#include "pipeline/made_mesh.h"
#include "pipeline/memory.h"
#include "pipeline/mesh_attempts.h"
#include "pipeline/mesh_measures.h"
#include "pipeline/mesh_outputs.h"
#include "pipeline/second_order.h"
#include "pipeline/stages.h"
#include "pipeline/too_thin.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

// Another h is tried for the number of tets that was asked for when it is missed by more than this.
constexpr double kTetsTolerance = .1;
// Pieces of psi = 0 are looked for on a grid of h and, where there is none, on so many grids twice as fine as the one
// before.
constexpr int kFinerGrids = 3;

class MeshStage {
 public:
  explicit MeshStage(const StageContext& context)
      : context_(context),
        domain_(load_domain(context.paths, context.parameters, &context.handover)),
        background_(context.parameters, domain_),
        keep_iterates_(context.parameters.flag("mesh.keep_iterates")) {}

  void run();

 private:
  MeshAttempt attempt(double h);
  void curve(MeshAttempt& a);
  MeshAttempt attempt_for_tets(double h);
  const ZeroSetChoice& pieces_at(double h);
  EdgeLength enough_for(const ThinPlaces& thin);
  std::string remedy_for(const ThinPlaces& thin, Json& h_enough);
  [[noreturn]] void refuse_thin(const MeshAttempt& best);
  bool observe(const UmProgress& p);
  UmResult make(const BackgroundMesh& background, const ZeroSetChoice& pieces);
  [[noreturn]] void refuse(const UmResult& result, double h);
  const StageContext& context_;
  Domain domain_;
  BackgroundChoice background_;
  const bool keep_iterates_;
  std::vector<std::vector<Vec3>> iterates_;                 ///< of the running attempt
  std::optional<std::pair<double, ZeroSetChoice>> pieces_;  ///< of psi cut for the h beside them
  double missed_by_ = 0;   ///< tets made / tets asked for, when the running attempt was given up for it
  bool may_miss_ = false;  ///< it goes on whatever the number
};

bool MeshStage::observe(const UmProgress& p) {
  const double n_rounds = static_cast<double>(context_.parameters.integer("mesh.projection_passes")) + 1;
  const std::string_view step = p.step;
  double rounds = 0;
  if (step == "submesh" && !may_miss_) {
    const double ratio = static_cast<double>(p.n_tets) / static_cast<double>(context_.parameters.integer("mesh.tets"));
    if (std::abs(ratio - 1) > kTetsTolerance) {
      missed_by_ = ratio;
      return false;
    }
  }
  if (step == "project") rounds = p.pass - 1 + static_cast<double>(p.sweep) / std::max(p.n_sweeps, 1);
  if (step == "relax") rounds = n_rounds - 1 + static_cast<double>(p.pass) / std::max(p.n_passes, 1);
  if (keep_iterates_ && step == "project" && p.sweep == p.n_sweeps) iterates_.push_back(*p.V);
  return context_.progress.report("mesh", step, .1 + .8 * rounds / n_rounds);
}

UmResult MeshStage::make(const BackgroundMesh& background, const ZeroSetChoice& pieces) {
  UmParams params = um_params(context_.parameters);
  // The full loop would mesh every piece; crawling starts from the ones to keep.
  if (!pieces.dropped.empty()) params.search = SubmeshSearch::Crawl;
  if (pieces.seeds.empty() && !pieces.dropped.empty()) {
    throw MeshingImpossible("psi = 0 is nowhere near the samples:\n  no " + pieces.dropped.front());
  }
  context_.progress.detail(fmt::format("mesh: h = {:.6g}, background of {} tets, psi = 0 in {} pieces", background.h(),
                                       background.n_tets(), pieces.topology.components.size()));
  UmResult result = universal_mesh(
      background, domain_.psi(), params, [this](const UmProgress& p) { return observe(p); }, pieces.seeds);
  round_to_file(result, domain_.shift);
  return result;
}

void MeshStage::refuse(const UmResult& result, double h) {
  if (!context_.paths.renews(Stage::Mesh)) begin_writing(context_, Stage::Mesh);
  const fs::path folder = write_failed_mesh(context_.paths, domain_, result);
  const std::size_t n = result.submesh.mesh.V.size();
  std::string message = failure_text(result, h, domain_.shift);
  if (n > 0) message += "\n  look at omega_h.vtu and projected.vtu (the last iterate) in " + folder.string();
  if (context_.paths.renews(Stage::Mesh)) message += "\n  the former mesh and its certificate have been kept";
  throw MeshingImpossible(message);
}

/// Cuts psi for h and finds the pieces of psi = 0.
const ZeroSetChoice& MeshStage::pieces_at(double h) {
  domain_.limit_detail(h);
  if (!pieces_ || pieces_->first != h) {
    context_.progress.report("mesh", "components", .05);
    // A body thinner than the grid may have no node inside.
    for (int halvings = 0; halvings <= kFinerGrids; ++halvings) {
      pieces_.emplace(h, choose_components(domain_, std::ldexp(h, -halvings), not_interrupted));
      if (!pieces_->second.topology.components.empty()) break;
    }
    stop_if_interrupted();
  }
  return pieces_->second;
}

// A smaller h lets detail in that may be thinner still; at most so often, and each time at least by a tenth.
constexpr int kThinRounds = 8;
constexpr double kThinStep = .9;

/// An h at which nothing is thin any more, as far as --max-tets allows.
EdgeLength MeshStage::enough_for(const ThinPlaces& thin) {
  EdgeLength choice{thin.h, least_h_of_max_tets(domain_, context_.parameters)};
  double needed = thin.h_needed();
  for (int round = 0; round < kThinRounds && choice.h > choice.least; ++round) {
    choice.h = std::max(std::min(needed, kThinStep * choice.h), choice.least);
    const ThinPlaces left = find_thin_places(domain_, pieces_at(choice.h), choice.h, not_interrupted);
    if (left.empty()) break;
    needed = left.h_needed();
  }
  return choice;
}

std::string MeshStage::remedy_for(const ThinPlaces& thin, Json& h_enough) {
  if (background_.own_h()) return fmt::format("a background with edges of {:.3g} may show them", thin.h_needed());
  const EdgeLength enough = enough_for(thin);
  if (!(enough.h < thin.h && enough.h > enough.least)) {
    return fmt::format("that takes more than {} tets: raise --max-tets", context_.parameters.integer("mesh.max_tets"));
  }
  h_enough = enough.h;
  return fmt::format("h = {:.3g} is enough, about {:.2g} tets", enough.h,
                     expected_tets(a15(), domain_.size(), enough.h));
}

/// Names what is too thin for the mesh that came out wrong, and writes it for the eye: beside a finished mesh where
/// there is none to be kept.
void MeshStage::refuse_thin(const MeshAttempt& best) {
  const ThinPlaces& thin = best.thin;
  const bool keeps = context_.paths.renews(Stage::Mesh);
  if (!keeps) begin_writing(context_, Stage::Mesh);
  const fs::path failed = write_failed_mesh(context_.paths, domain_, best.result);
  const fs::path folder = keeps ? failed : context_.paths.folder(Stage::Mesh);
  fs::create_directories(folder);
  const fs::path file = folder / "too_thin.vtp";
  write_thin_places(file, thin, domain_.shift);
  const std::size_t n = thin.places.size();
  std::string message = fmt::format("h = {:.4g} is too large: {}; {} place{} thinner than it can show\n{}\n  ", thin.h,
                                    best.complaint(), n, n == 1 ? " is" : "s are", described(thin, domain_.shift));
  Json h_enough;
  message += remedy_for(thin, h_enough) + "; --allow-thin keeps the mesh nevertheless\n  look at " + file.string();
  if (keeps) message += "\n  the former mesh and its certificate have been kept";
  throw TooThin(message, {{"too_thin", to_json(thin, domain_.shift)}, {"h_enough", h_enough}});
}

MeshAttempt MeshStage::attempt(double h) {
  MeshAttempt a;
  a.h = h;
  iterates_.clear();
  stop_if_interrupted();
  domain_.limit_detail(h);
  const BackgroundMesh background =
      background_.make(domain_, h, context_.parameters.integer("mesh.tets"), allowed_bytes(context_.parameters));
  const double n_files =
      3 + (keep_iterates_ ? static_cast<double>(context_.parameters.integer("mesh.projection_passes")) : 0);
  require_disk(context_.paths.root, n_files * expected_tets(a15(), domain_.size(), h));
  const ZeroSetChoice& pieces = pieces_at(h);
  a.thin = find_thin_places(domain_, pieces, h, not_interrupted);
  if (!a.thin.empty()) {
    context_.progress.detail(fmt::format("mesh: {} places are thinner than h = {:.4g} can show for certain:\n{}",
                                         a.thin.places.size(), h, described(a.thin, domain_.shift)));
  }
  for (const std::string& reason : pieces.dropped) context_.progress.say("mesh: left out a " + reason);
  stop_if_interrupted();
  a.result = make(background, pieces);
  a.iterates = std::move(iterates_);
  stop_if_interrupted();
  if (a.made()) {
    context_.progress.report("mesh", "certify", .9);
    a.measured = measure(domain_, a.result, pieces, h, not_interrupted);
    check_lost(domain_, a.result, a.thin, a.measured, not_interrupted);
    check_deviation(context_.parameters.real("mesh.max_deviation"), a.measured);
    curve(a);
    stop_if_interrupted();
  }
  return a;
}

void MeshStage::curve(MeshAttempt& a) {
  const std::int64_t order = context_.parameters.integer("mesh.order");
  a.measured["order"] = order;
  a.measured["second_order"] = nullptr;
  if (order < 2) return;
  stop_if_interrupted();
  context_.progress.report("mesh", "second order", .95);
  const ClosestPointParams params = um_params(context_.parameters).closest_point;
  a.second = curved_mesh(domain_, a.result, a.h, params, not_interrupted);
  measure_second_order(domain_, a.result, *a.second, a.h, a.measured, not_interrupted);
}

/// The estimate behind --tets knows the shape from a few thousand samples. Where it is far off, the number of tets at
/// the first h gives a second h, before anything is moved.
MeshAttempt MeshStage::attempt_for_tets(double h) {
  may_miss_ = context_.parameters.integer("mesh.tets") == 0;
  MeshAttempt a = attempt(h);
  if (missed_by_ == 0) return a;
  may_miss_ = true;
  const double better = std::max(h * std::cbrt(missed_by_), least_h_in_file(domain_));
  context_.progress.say(
      fmt::format("mesh: h = {:.4g} makes {:.2g} times the tets asked for; trying {:.4g}", h, missed_by_, better));
  return attempt(better);
}

void MeshStage::run() {
  const auto start = std::chrono::steady_clock::now();
  const std::vector<RecordedFile> inputs = recorded_inputs(context_.paths, Stage::Mesh, context_.parameters);
  context_.progress.report("mesh", "size", 0);
  const MeshAttempt best = best_attempt(
      background_.own_h() ? EdgeLength{*background_.own_h(), *background_.own_h()}
                          : choose_edge_length(domain_, context_.parameters, not_interrupted),
      [this](double h) { return attempt_for_tets(h); },
      [this](const std::string& line) { context_.progress.say(line); });
  const UmResult& result = best.result;
  const bool refuses_thin = !best.thin.empty() && !context_.parameters.flag("mesh.allow_thin");
  if (refuses_thin && !best.is_right() && !(best.made() && is_only_coarse(best.measured))) refuse_thin(best);
  if (!best.made()) refuse(result, best.h);

  context_.progress.report("mesh", "write", .97);
  const std::vector<std::string> outputs = write_mesh_outputs(context_, domain_, best);
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
               outputs);
  domain_.limit_detail(best.h);
  context_.handover.domain = std::move(domain_);
}

}  // namespace

UmParams um_params(const Parameters& p) {
  UmParams um;
  um.mode = p.text("mesh.mode") == "paper" ? UmMode::Paper : UmMode::Fast;
  um.fast.smoothing.target = um.fast.repair.target = p.real("mesh.target_quality");
  um.projection_passes = static_cast<int>(p.integer("mesh.projection_passes"));
  um.relaxation_iterations = static_cast<int>(p.integer("mesh.relaxation_iterations"));
  um.samples = static_cast<int>(p.integer("mesh.samples"));
  um.directions = p.text("mesh.directions") == "axes" ? DirectionRule::AxesInTurn : DirectionRule::Random;
  const std::string& projection = p.text("mesh.closest_point");
  um.closest_point.method = projection == "paper"    ? ClosestPointMethod::Paper
                            : projection == "damped" ? ClosestPointMethod::Damped
                                                     : ClosestPointMethod::Newton;
  um.rim = p.flag("mesh.complement") ? Rim::Wall : Rim::Refuse;
  um.max_min = p.text("mesh.max_min") == "golden" ? MaxMin::GoldenSection : MaxMin::Exact;
  um.seed = static_cast<std::uint64_t>(p.integer("mesh.seed"));
  std::string broken;
  for (const std::string& problem : problems(um)) broken += (broken.empty() ? "mesh: " : "; ") + problem;
  if (!broken.empty()) throw UsageError(broken);
  return um;
}

void run_mesh_stage(const StageContext& context) { MeshStage(context).run(); }

}  // namespace umtet
