#include "pipeline/run/run.h"

#include <fmt/format.h>

#include <algorithm>

#include "body/given_triangles.h"
#include "body/scan/cloud_preparation.h"
#include "body/sizing/wanted_detail.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/failure_file.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/case/option_words.h"
#include "pipeline/domain/body_options.h"
#include "pipeline/domain/edged_case.h"
#include "pipeline/output/report.h"
#include "pipeline/reports/certificate_json.h"
#include "pipeline/run/renewal.h"
#include "pipeline/stages/scan_source.h"
#include "pipeline/stages/stages.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

// Origin of --edges off in a case whose mesh with edges failed. It stays until the parameters are dropped.
constexpr const char* kLostEdges = "for a mesh that passes";

class CaseRun {
 public:
  CaseRun(const RunRequest& request, Progress& progress)
      : request_(request),
        progress_(progress),
        paths_{request.case_folder, {}, request.stamps},
        input_(request.input),
        parameters_(request.parameters),
        context_{paths_, parameters_, progress, request.threads, handover_, request.ranks} {}

  /// Inspects the case, and refuses a folder that umtet did not make.
  void begin();
  /// Returns the stages of this run.
  std::vector<Stage> stages() const;
  /// Makes the stage unless it is done. If it would replace a finished result, it is made beside it.
  StageRecord ensure(Stage stage);
  /// Makes the stages of this run. If a mesh with sharp edges fails, it is made again from one smooth level set.
  std::vector<StageRecord> make_all();
  /// Moves new results into place, and writes certificate and report.
  /// @param records  records of stages()
  RunOutcome finish(const std::vector<StageRecord>& records);
  /// Stores why the run ended, and writes the report of the stages that are done if no report of a mesh is in its
  /// place.
  void tell_failure(const std::exception_ptr& error);

 private:
  std::optional<Parameters> former_parameters();
  void take_former_parameters(const Parameters& former);
  void sample_for_h();
  void smooth_edges();
  void tell_changes(const Parameters& former);
  bool is_kept(Stage stage) const;
  fs::path source() const;
  const InputFile& input();
  StageState state_of(Stage stage);
  bool is_fine_enough(Stage stage, const StageRecord& record) const;
  bool lacks_parts(Stage stage, const StageState& state) const;
  bool must_run(Stage stage, const StageState& state) const;
  void make(Stage stage);
  void tell(Stage stage, const StageState& state) const;
  bool may_smooth_edges() const;
  std::string failure_of_edges(const std::vector<StageRecord>& records) const;
  void certify(const StageRecord& mesh);
  void report();

  const RunRequest& request_;
  Progress& progress_;
  CasePaths paths_;
  std::shared_ptr<const InputFile> input_;  ///< input(), once it is open
  Parameters
      parameters_;  ///< requested parameters; for finished stages outside the request, the parameters that made them
  Handover handover_;
  const StageContext context_;
  RunOutcome outcome_;
  Stage at_work_ = Stage::Cloud;  ///< the stage that was made last
};

/// Returns the parameters of case.toml; none if the file does not exist or is unusable.
std::optional<Parameters> CaseRun::former_parameters() {
  if (!fs::exists(paths_.parameters())) return std::nullopt;
  Parameters former;
  try {
    former.load(paths_.parameters(), ParamSource::Case);
  } catch (const ArtefactDamaged&) {
    if (request_.strict || std::any_of(std::begin(kStages), std::end(kStages), [&](Stage s) { return is_kept(s); }))
      throw;
    progress_.warn(paths_.parameters().string() + ": truncated, damaged or edited; making it again");
    return std::nullopt;
  }
  return former;
}

/// Returns whether this run leaves the stage alone.
bool CaseRun::is_kept(Stage stage) const {
  return (stage < request_.from || stage > request_.until) && fs::exists(paths_.record(stage));
}

/// Keeps the parameters of stages that this run leaves alone, so that case.toml still describes them.
void CaseRun::take_former_parameters(const Parameters& former) {
  for (const Stage stage : kStages) {
    if (is_kept(stage)) parameters_.copy_section(section_of(stage), former);
  }
  if (request_.until < Stage::Mesh && fs::exists(paths_.certificate())) parameters_.copy_section("output", former);
}

/// Reports the parameters that the case keeps from former calls, and those that change.
void CaseRun::tell_changes(const Parameters& former) {
  Parameters fresh;
  fresh.take_body(former);
  for (const KeptParameter& kept : parameters_.kept()) {
    const auto made_with = std::find_if(kStages.begin(), kStages.end(), [&](Stage stage) {
      return is_kept(stage) && kept.key.starts_with(section_of(stage) + std::string("."));
    });
    std::string why;
    if (made_with != kStages.end()) {
      why = fmt::format(" (the stage {} is not run)", to_string(*made_with));
    } else if (!request_.fresh && fresh.source(kept.key) != ParamSource::Case) {
      why = " (--fresh drops it)";
    }
    progress_.say("case: keeps " + kept.words + why);
    outcome_.kept.push_back(kept.words);
  }
  for (const char* section : {"cloud", "reconstruct", "mesh", "output"}) {
    for (std::string& change : differences(section, former.section(section), parameters_.section(section))) {
      progress_.say(fmt::format("case: {}", change));
      outcome_.changed.push_back(std::move(change));
    }
  }
  if (const std::string& was = former.cloud().file, &is = parameters_.cloud().file; was != is && !was.empty()) {
    outcome_.changed.push_back(fmt::format("{} was {}, is {}", keys::cloud::file, was, is.empty() ? "none" : is));
    progress_.say("case: " + outcome_.changed.back());
  }
}

/// Edges of a file replace those that angles show. Sharp edges are for flat tets of the fast mode, without walls; for
/// others the level set is one smooth function.
void CaseRun::smooth_edges() {
  const char* key = keys::reconstruct::edges;
  const bool is_derived = parameters_.source(key) == ParamSource::Derived;
  if (is_derived && parameters_.origin(key) != kLostEdges) parameters_.drop(key);
  take_given_edges(parameters_);
  if (parameters_.source(key) > ParamSource::Case || request_.until != Stage::Mesh) return;
  const MeshParameters& mesh = parameters_.mesh();
  const char* why = mesh.order > 1                 ? "for --order 2"
                    : mesh.mode == UmMode::Paper   ? "for --mode paper"
                    : mesh.box_walls               ? "for --box-walls"
                    : background_file(parameters_) ? "for --background"
                                                   : nullptr;
  if (!why) return;
  if (!parameters_.cloud().features.empty())
    progress_.warn(fmt::format("mesh: the edges of --features are rounded {}", why));
  parameters_.set(key, "off", ParamSource::Derived, why);
}

/// Triangles are sampled as finely as the mesh needs, unless the user sets the spacing. The spacing is a parameter like
/// all others, so another h makes other samples; a spacing derived from a former h is dropped with it. The same applies
/// to closing openings before psi is fitted.
void CaseRun::sample_for_h() {
  if (request_.from != Stage::Cloud || !parameters_.mesh().implicit.empty()) return;
  const Closing close = parameters_.reconstruct().close;
  const bool is_left = parameters_.reconstruct().keep_open || close == Closing::Smooth || close == Closing::None;
  if (parameters_.source(keys::cloud::cap) == ParamSource::Derived) parameters_.drop(keys::cloud::cap);
  if (is_left && parameters_.source(keys::cloud::cap) <= ParamSource::Case)
    parameters_.set(keys::cloud::cap, "false", ParamSource::Derived, "for --close");
  smooth_edges();
  if (request_.until != Stage::Mesh) return;
  const char* key = keys::cloud::sample_spacing;
  if (parameters_.source(key) == ParamSource::Derived) parameters_.drop(key);
  if (parameters_.source(key) > ParamSource::Case || parameters_.cloud().sample_spacing > 0) return;
  if (!(parameters_.mesh().h > 0) || !fs::is_regular_file(source()) || !is_of_triangles(input(), parameters_)) return;
  parameters_.drop(key);
  parameters_.set(key, fmt::format("{}", parameters_.mesh().h / kSamplesAnEdge), ParamSource::Derived, "for --h");
}

/// Returns the cloud of the request, else that of the case; empty if there is none.
fs::path CaseRun::source() const {
  return request_.source.empty() ? fs::path(parameters_.cloud().file) : request_.source;
}

/// Returns source(), which the first call opens. \throw as open_source()
const InputFile& CaseRun::input() {
  if (!input_) input_ = open_source(source());
  return *input_;
}

StageState CaseRun::state_of(Stage stage) {
  std::optional<std::vector<RecordedFile>> inputs;
  // A stage that is taken as it is may have been made from other input.
  if (stage >= request_.from) {
    if (stage != Stage::Cloud) inputs = recorded_inputs(paths_, stage, parameters_);
    if (stage == Stage::Cloud && !request_.source.empty()) inputs = source_inputs(input(), parameters_, *paths_.stamps);
  }
  return inspect_stage(paths_, stage, parameters_.section(section_of(stage)), inputs);
}

/// If samples are dense, the first stages keep only the detail that the requested mesh can show.
bool CaseRun::is_fine_enough(Stage stage, const StageRecord& record) const {
  if (stage == Stage::Mesh || request_.until != Stage::Mesh) return true;
  const std::optional<Json> wanted = wanted_of(record);
  return !wanted || *wanted == wanted_mesh(parameters_);
}

/// Returns whether a mesh is done but the local meshes of the processes are missing. A mesh of a single process, which
/// has sizes, never had local meshes.
bool CaseRun::lacks_parts(Stage stage, const StageState& state) const {
  return stage == Stage::Mesh && request_.ranks && request_.needs_parts && !mesh_report(*state.record).measured.sizes;
}

/// Reports why a stage is not done. Changes that tell_changes() has reported are not repeated.
void CaseRun::tell(Stage stage, const StageState& state) const {
  const Json now = parameters_.section(section_of(stage));
  std::vector<std::string> reasons = differences(section_of(stage), state.record->parameters, now);
  const auto is_told = [&](const std::string& reason) {
    return std::find(outcome_.changed.begin(), outcome_.changed.end(), reason) != outcome_.changed.end();
  };
  const bool all_told = !reasons.empty() && std::all_of(reasons.begin(), reasons.end(), is_told);
  progress_.say(fmt::format("{}: {}", to_string(stage), all_told ? "made again with other parameters" : state.reason));
}

bool CaseRun::must_run(Stage stage, const StageState& state) const {
  using Kind = StageState::Kind;
  const std::string name = to_string(stage);
  if (state.kind == Kind::Damaged) {
    if (request_.strict) throw ArtefactDamaged(state.reason);
    progress_.warn(name + ": " + state.reason + "; making it again");
    return true;
  }
  if (stage < request_.from) {
    if (state.kind == Kind::Missing) {
      throw UsageError(state.reason + ": run the stage " + name + " first (umtet run, umtet reconstruct)");
    }
    if (!is_fine_enough(stage, *state.record))
      progress_.warn(name + ": made for a mesh of another resolution (umtet run makes it again)");
    return false;
  }
  if (state.kind == Kind::Changed) tell(stage, state);
  if (state.kind == Kind::Done && !is_fine_enough(stage, *state.record)) {
    progress_.say(name + ": made for a mesh of another resolution");
    return true;
  }
  if (state.kind == Kind::Done && lacks_parts(stage, state)) {
    progress_.say("mesh: made again, for files to which each process writes its part");
    return true;
  }
  return request_.force || state.kind != Kind::Done;
}

StageRecord CaseRun::ensure(Stage stage) {
  stop_if_interrupted();
  StageState state = state_of(stage);
  if (!must_run(stage, state)) return *state.record;
  if (holds_results(paths_, stage)) {
    paths_.renews(stage) = true;
    if (!request_.force) state = state_of(stage);
    if (!request_.force && state.kind == StageState::Kind::Done && is_fine_enough(stage, *state.record) &&
        !lacks_parts(stage, state)) {
      progress_.say(std::string(to_string(stage)) + ": done by an earlier run that was not finished");
      return *state.record;
    }
  }
  make(stage);
  outcome_.stages_run.push_back(stage);
  state = state_of(stage);
  if (!state.record) throw ArtefactDamaged(state.reason);
  progress_.say(fmt::format("{}: done in {:.2f} s", to_string(stage), state.record->run.seconds));
  return *state.record;
}

void CaseRun::make(Stage stage) {
  set_work_at_hand(to_string(stage));
  at_work_ = stage;
  try {
    if (stage == Stage::Cloud) {
      if (source().empty()) throw UsageError("no cloud given");
      run_cloud_stage(context_, input());
    } else if (stage == Stage::LevelSet) {
      run_level_set_stage(context_);
    } else {
      run_mesh_stage(context_);
    }
  } catch (...) {
    // An unfinished stage is useless; complete stages before it are kept for the next run.
    std::error_code ignored;
    if (paths_.renews(stage)) fs::remove_all(paths_.folder(stage), ignored);
    throw;
  }
}

void CaseRun::certify(const StageRecord& mesh) {
  set_work_at_hand("certificate");
  outcome_.certificate = certificate(paths_, mesh, parameters_);
  const std::string text = file_text(to_json(*outcome_.certificate));
  const fs::path file = paths_.certificate();
  const bool exists = fs::exists(file);
  const std::string former = exists ? read_text(file) : "";
  if (former != text) {
    if (exists && !seal_holds(Json::parse(former, nullptr, false))) {
      const std::string reason = file.string() + " does not match its own checksum";
      if (request_.strict) throw ArtefactDamaged(reason);
      progress_.warn("certificate: " + reason + "; making it again");
    }
    write_text_artefact(file, text);
  }
  if (!outcome_.certificate->verdict.passes()) outcome_.code = ExitCode::GateFailed;
}

/// Writes the report of the certificate beside it; otherwise there is no report.
void CaseRun::report() {
  const bool fits = report_is_of(paths_, *outcome_.certificate, parameters_);
  if (!request_.report && !fits) fs::remove(paths_.report());
  if (request_.report && (!fits || request_.force)) {
    set_work_at_hand("report");
    progress_.report("report", "write", .5);
    write_report(paths_, parameters_, *outcome_.certificate, handover_);
  }
  if (fs::exists(paths_.report())) outcome_.files.push_back(paths_.report());
}

void CaseRun::begin() {
  refuse_foreign_folder(paths_);
  remove_stale_temporaries(paths_.root);  // of a run that was killed after its stages were done
  const std::optional<Parameters> former = former_parameters();
  if (former) take_former_parameters(*former);
  sample_for_h();
  if (former) tell_changes(*former);
}

std::vector<Stage> CaseRun::stages() const {
  const bool is_alone = request_.until == Stage::Mesh && has_own_psi(parameters_.mesh());
  std::vector<Stage> list;
  for (const Stage stage : kStages) {
    if (stage <= request_.until && (!is_alone || stage == Stage::Mesh)) list.push_back(stage);
  }
  return list;
}

/// Returns whether the user leaves it to the program to keep edges, and the level set may be made again.
bool CaseRun::may_smooth_edges() const {
  return request_.from <= Stage::LevelSet && request_.until == Stage::Mesh && !has_own_psi(parameters_.mesh()) &&
         parameters_.source(keys::reconstruct::edges) <= ParamSource::Case &&
         parameters_.reconstruct().edges == SharpEdgeUse::Auto && fs::exists(paths_.record(Stage::LevelSet)) &&
         has_edges(read_record(paths_, Stage::LevelSet));
}

/// Returns the first reason for which a mesh with edges is wrong; empty if it is right, whatever else is asked of it.
std::string CaseRun::failure_of_edges(const std::vector<StageRecord>& records) const {
  const Verdict verdict = judge(mesh_report(records.back()).measured, parameters_.output());
  const bool is_right = verdict.is_valid && verdict.fits_psi && verdict.fits_input;
  return is_right || verdict.passes() ? "" : verdict.reasons.front();
}

std::vector<StageRecord> CaseRun::make_all() {
  std::vector<StageRecord> records;
  std::string failure;
  try {
    for (const Stage stage : stages()) records.push_back(ensure(stage));
    if (may_smooth_edges()) failure = failure_of_edges(records);
  } catch (const MeshingImpossible& e) {
    if (!may_smooth_edges()) throw;
    failure = text_of(e.message, as_flag);
  } catch (const ResourceLimit& e) {
    if (!may_smooth_edges()) throw;
    failure = text_of(e.message, as_flag);
  }
  if (failure.empty()) return records;
  progress_.warn(
      "mesh: with sharp edges it fails (" + failure +
      "); making it again from one smooth level set, which rounds them (--edges auto shows the one that fails)");
  parameters_.set(keys::reconstruct::edges, "off", ParamSource::Derived, kLostEdges);
  records.clear();
  for (const Stage stage : stages()) records.push_back(ensure(stage));
  return records;
}

RunOutcome CaseRun::finish(const std::vector<StageRecord>& records) {
  if (request_.keeps_parts) outcome_.parts = handover_.parts;
  handover_.parts.reset();
  replace_former(context_, paths_, outcome_.stages_run);
  write_parameters(paths_, parameters_);
  remove_failure(paths_);
  for (const StageRecord& record : records) {
    for (const RecordedFile& f : record.outputs) outcome_.files.push_back(paths_.folder(record.stage) / f.name);
  }
  if (request_.until == Stage::Mesh) {
    certify(records.back());
    outcome_.files.push_back(paths_.certificate());
    report();
  }
  return std::move(outcome_);
}

/// A failure to tell a failure must not hide the first one.
void CaseRun::tell_failure(const std::exception_ptr& error) {
  try {
    const Failure failure = failure_of(error);
    write_failure(paths_, {at_work_, failure.code, failure.message});
    const bool is_told = failure.code == ExitCode::ReconstructionFailed || failure.code == ExitCode::MeshingImpossible;
    const CasePaths former{paths_.root};
    if (!is_told || !request_.report || fs::exists(former.certificate()) || !fs::exists(former.parameters())) return;
    write_unfinished_report(former, parameters_);
    progress_.say("report: " + former.report().string() + " shows the stages that are done");
  } catch (...) {
  }
}

}  // namespace

RunOutcome run_case(const RunRequest& request, Progress& progress) {
  const CaseLock lock(request.case_folder);
  CaseRun run(request, progress);
  run.begin();
  try {
    return run.finish(run.make_all());
  } catch (...) {
    run.tell_failure(std::current_exception());
    throw;
  }
}

}  // namespace umtet
