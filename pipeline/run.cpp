#include "pipeline/run.h"

#include <algorithm>

#include "pipeline/certificate_json.h"
#include "pipeline/interrupt.h"
#include "pipeline/stages.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

class CaseRun {
 public:
  CaseRun(const RunRequest& request, Progress& progress)
      : request_(request),
        progress_(progress),
        paths_{request.case_folder},
        context_{paths_, request.parameters, progress, request.threads} {}

  RunOutcome operator()();

 private:
  StageState state_of(Stage stage) const;
  bool must_run(Stage stage, const StageState& state) const;
  void run(Stage stage);
  void certify(const StageRecord& mesh);

  const RunRequest& request_;
  Progress& progress_;
  const CasePaths paths_;
  const StageContext context_;
  RunOutcome outcome_;
};

StageState CaseRun::state_of(Stage stage) const {
  std::optional<std::vector<RecordedFile>> inputs;
  // A stage that is taken as it is may have been made from other input.
  if (stage >= request_.from) {
    if (stage != Stage::Cloud) inputs = recorded_inputs(paths_, stage, request_.parameters);
    if (stage == Stage::Cloud && !request_.source.empty()) inputs = {source_input(request_.source)};
  }
  return inspect_stage(paths_, stage, request_.parameters.section(section_of(stage)), inputs);
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
      throw UsageError(state.reason + ": the stage " + name + " has to be run first (umtet run, umtet reconstruct)");
    }
    return false;
  }
  if (state.kind == Kind::Changed) progress_.say(name + ": " + state.reason);
  return request_.force || state.kind != Kind::Done;
}

void CaseRun::run(Stage stage) {
  if (stage == Stage::Cloud) {
    fs::path source = request_.source;
    if (source.empty()) source = request_.parameters.text("cloud.file");
    if (source.empty()) throw UsageError("no cloud: give one");
    run_cloud_stage(context_, source);
  } else if (stage == Stage::LevelSet) {
    run_level_set_stage(context_);
  } else {
    run_mesh_stage(context_);
  }
}

void CaseRun::certify(const StageRecord& mesh) {
  const Json json = certificate(paths_, mesh, request_.parameters);
  const std::string text = json.dump(2) + "\n";
  const fs::path file = paths_.certificate();
  if (!fs::exists(file) || read_text(file) != text) write_text_artefact(file, text);
  outcome_.certificate = json;
  outcome_.files.push_back(file);
  if (json.at("verdict") != "pass") outcome_.code = ExitCode::GateFailed;
}

RunOutcome CaseRun::operator()() {
  const bool has_formula = !request_.parameters.text("mesh.implicit").empty();
  const CaseLock lock(paths_.root);
  for (const Stage stage : {Stage::Cloud, Stage::LevelSet, Stage::Mesh}) {
    if (stage > request_.until || (has_formula && stage != Stage::Mesh)) continue;
    stop_if_interrupted();
    StageState state = state_of(stage);
    if (must_run(stage, state)) {
      run(stage);
      outcome_.stages_run.push_back(stage);
      state = state_of(stage);
      if (!state.record) throw ArtefactDamaged(state.reason);
      progress_.say(std::string(to_string(stage)) + ": done in " +
                    std::to_string(state.record->run.value("seconds", 0.)).substr(0, 5) + " s");
    }
    for (const RecordedFile& f : state.record->outputs) outcome_.files.push_back(paths_.folder(stage) / f.name);
    if (stage == Stage::Mesh) certify(*state.record);
  }
  // Parameters that no stage depends on (output.*) are part of the record of what was asked.
  const std::string text = request_.parameters.toml();
  if (!fs::exists(paths_.parameters()) || read_text(paths_.parameters()) != text) {
    write_text_artefact(paths_.parameters(), text);
  }
  return std::move(outcome_);
}

}  // namespace

RunOutcome run_case(const RunRequest& request, Progress& progress) { return CaseRun(request, progress)(); }

}  // namespace umtet
