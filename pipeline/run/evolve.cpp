#include "pipeline/run/evolve.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <optional>

#include "body/body.h"
#include "body/search/mesh_maker.h"
#include "body/sizing/background_choice.h"
#include "body/sizing/edge_length.h"
#include "mesh/universal_mesh.h"
#include "pipeline/case/artefact.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/case/memory.h"
#include "pipeline/case/option_words.h"
#include "pipeline/domain/body_options.h"
#include "pipeline/domain/load_domain.h"
#include "pipeline/meshing/made_mesh.h"
#include "pipeline/meshing/part_mesher.h"
#include "pipeline/reports/certificate_json.h"
#include "pipeline/run/evolve_tables.h"
#include "pipeline/run/run.h"
#include "pipeline/run/time_steps.h"
#include "pipeline/stages/stages.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

using Step = EvolveStep;

/// Returns whether a failure concerns a single instant, so that others may succeed.
bool concerns_one_step(ExitCode code) {
  switch (code) {
    case ExitCode::Usage:  // a formula that is undefined at this t
    case ExitCode::InputRefused:
    case ExitCode::ReconstructionFailed:
    case ExitCode::MeshingImpossible:
    case ExitCode::FileTrouble:  // the cloud of the instant: no files of umtet are written where this is called
    case ExitCode::ArtefactCorrupt:
    case ExitCode::ResourceLimit:
      return true;
    default:
      return false;
  }
}

double least_quality(const Step& step) { return step.measured->mesh.quality.min; }

/// Returns a step for the answer to --json.
Json to_json(const Step& step) {
  Json json = {{"t", step.at.t}, {"file", step.made() ? Json(step.file) : Json(nullptr)}, {"seconds", step.seconds}};
  if (step.made()) {
    json.update(to_json(*step.measured, step.verdict));
  } else {
    json["error"] = step.error;
  }
  return json;
}

class Evolution {
 public:
  Evolution(const EvolveRequest& request, Progress& progress)
      : request_(request), parameters_(request.parameters), progress_(progress), of_clouds_(!request.clouds.empty()) {
    um_params(parameters_.mesh());                  // an error in them concerns all instants
    if (parameters_.mesh().background == "auto") {  // one background serves all instants, so no single instant decides
      parameters_.set(keys::mesh::background, is_graded(parameters_) ? "graded" : "a15", ParamSource::Flag, "evolve");
    }
    // Tets are identified from instant to instant by their numbers in the background.
    parameters_.set(keys::mesh::flips, "false", ParamSource::Flag, "evolve");
    for (TimeStep& at : time_steps(request.times, request.skip, request.clouds)) {
      const std::string name = fmt::format("step_{:04}.vtu", steps_.size());
      Step& step = steps_.emplace_back();
      step.at = std::move(at);
      step.file = name;
    }
  }

  EvolveOutcome operator()();

 private:
  void take_folder();
  CasePaths case_of(const Step& step) const {
    return {request_.folder / "clouds" / fs::path(step.file).replace_extension(), {}, stamps_};
  }
  Domain domain_of(const Step& step) const;
  void look_at(Step& step);
  void choose_background();
  void mesh(Step& step);
  MeshAttempt make(Step& step, Domain& domain);
  void write(const Step& step, const Domain& domain, const MeshAttempt& made) const;
  EvolveOutcome outcome() const;
  template <class F>
  void guarded(Step& step, const F& f);
  bool report(const Step& step, std::string_view what, double part) const {
    const double k = static_cast<double>(&step - steps_.data());
    return progress_.report(what, "t = " + time_text(step.at.t), (k + part) / static_cast<double>(steps_.size()));
  }

  const EvolveRequest& request_;
  Parameters parameters_;
  Progress& progress_;
  const bool of_clouds_;
  std::vector<Step> steps_;
  std::optional<Domain> first_;  ///< domain of the first instant that has one, with the box of all instants
  double h_ = 0;
  std::optional<BackgroundChoice> choice_;
  std::optional<SizedBackground> background_;
  const std::shared_ptr<FileStamps> stamps_ = std::make_shared<FileStamps>();
};

/// Runs f and records failures that concern this instant alone.
template <class F>
void Evolution::guarded(Step& step, const F& f) {
  const auto start = std::chrono::steady_clock::now();
  try {
    f();
  } catch (const CallsDiffer&) {
    throw;  // these failures would repeat at each step
  } catch (...) {
    const Failure failure = failure_of(std::current_exception());
    if (!concerns_one_step(failure.code)) throw;
    step.error = failure.message;
    step.thrown = std::current_exception();
    progress_.warn(fmt::format("t = {}: {}", time_text(step.at.t), step.error));
  }
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  step.seconds += seconds.count();
}

/// Removes the steps of a former run.
void Evolution::take_folder() {
  const bool ours = fs::exists(request_.folder / kSeries);
  std::vector<fs::path> former;
  for (const fs::directory_entry& entry : fs::directory_iterator(request_.folder)) {
    const std::string name = entry.path().filename().string();
    if (name[0] == '.') continue;
    if (!ours) {
      throw UsageError(entry.path().string() + " is in the way: " + request_.folder.string() +
                       " is not a folder of umtet evolve; choose another folder with -o");
    }
    if (name.starts_with("step_") && name.ends_with(".vtu")) former.push_back(entry.path());
  }
  remove_stale_temporaries(request_.folder);
  write_tables(request_.folder, steps_);
  for (const fs::path& file : former) fs::remove(file);
}

Domain Evolution::domain_of(const Step& step) const {
  return of_clouds_ ? load_domain(case_of(step), parameters_) : formula_domain(parameters_, step.at.t);
}

/// Makes the level set of a cloud, and collects what the background needs to know of every instant.
void Evolution::look_at(Step& step) {
  step.looked_at = true;
  if (of_clouds_) {
    report(step, "level set", 0);
    RunRequest run;
    run.case_folder = case_of(step).root;
    run.stamps = stamps_;
    run.source = step.at.cloud;
    run.parameters = parameters_;
    run.parameters.set(keys::cloud::file, step.at.cloud.string(), ParamSource::Flag, "--clouds");
    run.until = Stage::LevelSet;
    run.threads = request_.threads;
    run.ranks = request_.ranks;
    run_case(run, progress_);
  }
  Domain domain = domain_of(step);
  if (first_ && domain.shift != first_->shift) {
    const Vec3 d = domain.shift - first_->shift;
    throw MeshingImpossible(fmt::format(
        "this cloud is ({:.3g}, {:.3g}, {:.3g}) away from the first cloud, and so far from the origin that both "
        "are shifted, by different vectors: move all clouds closer to the origin",
        d.x(), d.y(), d.z()));
  }
  if (!choice_) choice_.emplace(body_options(parameters_), domain);
  const bool counts = !first_ || parameters_.mesh().tets == 0;
  if (is_graded(parameters_)) {
    h_ = choice_->edge_length(domain, until_interrupted()).h;  // smallest of all instants so far
  } else if (counts) {
    const double h = choice_->edge_length(domain, until_interrupted()).h;
    h_ = first_ ? std::min(h_, h) : h;
  }
  if (first_) {
    first_->box.extend(domain.box);
  } else {
    first_.emplace(std::move(domain));
  }
}

void Evolution::choose_background() {
  // A formula has the same box at all times; if h is given, too, the other instants can wait until their turn.
  const bool one_tells_all =
      !of_clouds_ && !is_graded(parameters_) && (parameters_.mesh().h > 0 || parameters_.mesh().tets > 0);
  for (Step& step : steps_) {
    stop_if_interrupted();
    guarded(step, [&] { look_at(step); });
    if (first_ && one_tells_all) break;
  }
  if (!first_) std::rethrow_exception(steps_.front().thrown);
  first_->limit_detail(h_);
  const double allowed = request_.ranks ? request_.ranks->allowed_bytes(parameters_) : allowed_bytes(parameters_);
  background_ = choice_->make(*first_, h_, parameters_.mesh().tets, allowed);
  progress_.say(fmt::format("one background of {} tets, h = {:.6g}", background_->mesh.n_tets(), h_));
}

/// Makes the mesh of a step in the same way as umtet mesh with a given h.
MeshAttempt Evolution::make(Step& step, Domain& domain) {
  const Context call{.progress = [&](const char* at, double part) { report(step, at, part); },
                     .cancelled = until_interrupted().cancelled};
  if (request_.ranks) request_.ranks->forget_domain(of_clouds_ ? std::nullopt : std::optional(step.at.t));
  MeshMaker maker(domain, body_options(parameters_), call,
                  {.say = [this](const Message& line) { progress_.say(text_of(line, as_flag)); }}, request_.ranks);
  MeshAttempt a = maker.attempt(*background_, h_);
  stop_if_interrupted();
  if (a.fell_through()) throw MeshingImpossible(too_thin_text(a, domain.shift));
  if (!a.made()) throw MeshingImpossible(failure_text(a.result, h_, domain.shift));
  step.verdict = judge(a.measured, parameters_.output());
  step.measured = std::move(a.measured);
  return a;
}

void Evolution::write(const Step& step, const Domain& domain, const MeshAttempt& made) const {
  const fs::path file = request_.folder / step.file;
  if (!made.parts) return write_mesh(file, final_content(domain, made.result));
  write_artefact(file, [&](const fs::path& temporary) {
    written_in_parts(made.parts)->write(temporary, MeshState::Final, false, boundary_data(domain, made.result));
  });
}

void Evolution::mesh(Step& step) {
  stop_if_interrupted();
  if (!step.error.empty()) return;
  report(step, "mesh", 0);
  std::optional<Domain> domain;
  std::optional<MeshAttempt> made;
  guarded(step, [&] {
    if (!step.looked_at) look_at(step);
    domain.emplace(domain_of(step));
    made = make(step, *domain);
  });
  stop_if_interrupted();
  if (made) write(step, *domain, *made);
  write_tables(request_.folder, steps_);
  if (!made) return;
  const MeshCertificate& certificate = step.measured->mesh;
  progress_.say(fmt::format("t = {}: {} tets, min Q {:.4f}, {}", time_text(step.at.t), certificate.n_tets,
                            certificate.quality.min, step.verdict.word()));
}

EvolveOutcome Evolution::outcome() const {
  EvolveOutcome result;
  std::size_t n_made = 0, n_passed = 0;
  const Step* worst = nullptr;
  std::string troubles;
  for (const Step& step : steps_) {
    result.steps.push_back(to_json(step));
    if (!step.made()) {
      troubles += fmt::format("not made  t = {}: {}\n", time_text(step.at.t), step.error);
    } else {
      ++n_made;
      n_passed += step.verdict.passes();
      for (const std::string& reason : step.verdict.reasons) {
        troubles += fmt::format("failed    t = {}: {}\n", time_text(step.at.t), reason);
      }
      if (!worst || least_quality(step) < least_quality(*worst)) worst = &step;
    }
  }
  if (n_passed < steps_.size()) result.code = ExitCode::GateFailed;
  result.text = fmt::format("steps     {} of {} made, {} of them certified, in one background of {} tets; h = {:.5g}\n",
                            n_made, steps_.size(), n_passed, background_->mesh.n_tets(), h_);
  if (worst) {
    result.text +=
        fmt::format("quality   worst min Q {:.4f}, at t = {}\n", least_quality(*worst), time_text(worst->at.t));
  }
  result.text += troubles;
  for (const char* name : {kSeries, "quality.csv", "quality.svg"}) result.files.push_back(request_.folder / name);
  return result;
}

EvolveOutcome Evolution::operator()() {
  const CaseLock lock(request_.folder);
  take_folder();
  choose_background();
  for (Step& step : steps_) mesh(step);
  return outcome();
}

}  // namespace

EvolveOutcome evolve(const EvolveRequest& request, Progress& progress) { return Evolution(request, progress)(); }

}  // namespace umtet
