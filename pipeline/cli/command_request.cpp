#include <filesystem>

#include "pipeline/cli/command_line.h"
#include "pipeline/cli/detail/command_parser.h"
#include "pipeline/output/boundary_patches.h"
#include "pipeline/output/export_case.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

class RequestMaker {
 public:
  RequestMaker(const CLI::App& command, const CommandInputs& in, CommandLine& call)
      : command_(command), in_(in), call_(call) {}
  void finish();

 private:
  void read_parameters();
  void finish_stages();
  void finish_evolve();
  void finish_batch();
  void take_cloud();

  const CLI::App& command_;
  const CommandInputs& in_;
  CommandLine& call_;
};

void RequestMaker::finish() {
  call_.command = command_.get_name();
  if (in_.quiet && in_.verbose) throw UsageError("-q and -v exclude each other");
  call_.verbosity = in_.quiet ? Verbosity::Quiet : in_.verbose ? Verbosity::Verbose : Verbosity::Normal;
  // The flags of all commands share their storage; only those of this one have been touched.
  Parameters& parameters = call_.request.parameters;
  for (const ParamField& f : params_fields()) {
    const CLI::Option* option = f.flag.empty() ? nullptr : command_.get_option_no_throw(f.flag);
    if (!option || option->count() == 0) continue;
    const bool is_switch = std::holds_alternative<bool>(f.preset);
    parameters.set(f.key, is_switch ? (in_.switches.at(f.key) ? "true" : "false") : in_.values.at(f.key),
                   ParamSource::Flag, f.flag);
  }
  call_.formats = in_.formats;
  require_formats(call_.formats);
  parse_label_names(parameters.output().label_names);
  if (call_.command == "check") {
    call_.action = CommandLine::Action::Check;
    call_.mesh = in_.input;
    if (!in_.against.empty()) call_.against = in_.against;
    read_parameters();
  } else if (call_.command == "inspect") {
    call_.action = CommandLine::Action::Inspect;
    call_.cloud = in_.input;
  } else if (call_.command == "export") {
    call_.action = CommandLine::Action::Export;
    call_.request.case_folder = in_.input;
    const fs::path toml = CasePaths{in_.input}.parameters();
    if (fs::exists(toml)) parameters.load(toml, ParamSource::Case);
    call_.formats = in_.formats;
  } else if (call_.command == "report") {
    call_.action = CommandLine::Action::Report;
    call_.request.case_folder = in_.input;
  } else if (call_.command == "view") {
    call_.action = CommandLine::Action::View;
    call_.request.case_folder = in_.input;
  } else if (call_.command == "diff") {
    call_.action = CommandLine::Action::Diff;
    call_.case_a = in_.input;
    call_.case_b = in_.other_case;
  } else if (call_.command == "evolve") {
    call_.action = CommandLine::Action::Evolve;
    finish_evolve();
  } else if (call_.command == "batch") {
    call_.action = CommandLine::Action::Batch;
    finish_batch();
  } else {
    call_.action = CommandLine::Action::Stages;
    finish_stages();
  }
}

/// --set and --config. A file may be about more than this command; --set and flags are refused where they would change
/// nothing.
void RequestMaker::read_parameters() {
  Parameters& parameters = call_.request.parameters;
  for (const std::string& assignment : in_.assignments) parameters.set(assignment);
  for (const Stage stage : {Stage::Cloud, Stage::LevelSet, Stage::Mesh}) {
    const RunRequest& r = call_.request;
    const bool runs = call_.action != CommandLine::Action::Check;
    if (runs && stage >= r.from && stage <= r.until) continue;
    for (const ParamField& f : params_fields()) {
      if (f.key.starts_with(std::string(section_of(stage)) + ".") && parameters.source(f.key) >= ParamSource::Set) {
        throw UsageError(f.key + " belongs to a stage that this command does not run");
      }
    }
  }
  if (!in_.config.empty()) parameters.load(in_.config, ParamSource::File);
}

void RequestMaker::finish_evolve() {
  if (in_.clouds.empty()) call_.request.from = Stage::Mesh;
  read_parameters();
  const bool formula = !call_.request.parameters.mesh().implicit.empty();
  if (formula != in_.clouds.empty()) throw UsageError("evolve: give --implicit EXPR with --box, or --clouds LIST");
  if (call_.request.parameters.mesh().order != 1) throw UsageError("evolve: mesh.order must be 1");
  if (in_.output.empty()) throw UsageError("evolve: -o FOLDER is missing");
  call_.evolve.folder = in_.output;
  call_.evolve.clouds = in_.clouds;
  call_.evolve.times = in_.times;
  call_.evolve.skip = in_.skip;
}

void RequestMaker::finish_batch() {
  read_parameters();
  if (in_.output.empty()) throw UsageError("batch: -o FOLDER is missing");
  if (!call_.request.parameters.mesh().implicit.empty()) throw UsageError("batch: mesh.implicit is no scan");
  BatchRequest& batch = call_.batch;
  batch.list = in_.input;
  batch.folder = in_.output;
  batch.resume = in_.resume;
  batch.force = in_.force;
  batch.strict = in_.strict;
}

void RequestMaker::finish_stages() {
  const std::string name = command_.get_name();
  RunRequest& request = call_.request;
  Parameters& parameters = request.parameters;
  request.force = in_.force;
  request.strict = in_.strict;
  request.report = !in_.no_report;
  const bool input_is_case = !in_.input.empty() && (name == "mesh" || fs::is_directory(in_.input));
  if (name == "reconstruct") request.until = Stage::LevelSet;
  if (name == "mesh" || (name == "reconstruct" && input_is_case)) {
    request.from = name == "mesh" ? Stage::Mesh : Stage::LevelSet;
  }
  if (!in_.from.empty()) request.from = parse_stage(in_.from);
  if (!in_.until.empty()) request.until = parse_stage(in_.until);
  if (!in_.formats.empty() && request.until != Stage::Mesh)
    throw UsageError("--export needs a mesh, and --until is before it");
  if (request.from > request.until) throw UsageError("--from " + in_.from + " is after --until " + in_.until);

  read_parameters();
  if (input_is_case) {
    if (parameters.source(keys::mesh::implicit) == ParamSource::Flag)
      throw UsageError("--implicit goes with -o, without CASE");
    if (!in_.output.empty() && fs::path(in_.output) != fs::path(in_.input)) {
      throw UsageError("-o " + in_.output + ": the case is " + in_.input + " already");
    }
    request.case_folder = in_.input;
    const fs::path toml = CasePaths{in_.input}.parameters();
    if (!fs::exists(toml)) throw UsageError(in_.input + " is not a case: it has no case.toml");
    parameters.load(toml, ParamSource::Case);
    if (request.from == Stage::Cloud && parameters.source(keys::cloud::file) > ParamSource::Case) take_cloud();
    return;
  }
  if (in_.output.empty()) throw UsageError(name + ": -o CASE is missing");
  request.case_folder = in_.output;
  if (name == "mesh") {
    if (parameters.mesh().implicit.empty()) throw UsageError("mesh: give a CASE, or --implicit EXPR with --box and -o");
    return;
  }
  if (!in_.input.empty()) parameters.set(keys::cloud::file, in_.input, ParamSource::Flag, "command line");
  if (parameters.cloud().file.empty() && request.from == Stage::Cloud) throw UsageError(name + ": CLOUD is missing");
  if (request.from == Stage::Cloud) take_cloud();
}

/// The cloud that was named: to be read, and to be found again from another folder.
void RequestMaker::take_cloud() {
  Parameters& parameters = call_.request.parameters;
  call_.request.source = parameters.cloud().file;
  parameters.make_cloud_absolute();
}

}  // namespace

void fill_request(const CLI::App& command, const CommandInputs& in, CommandLine& result) {
  RequestMaker(command, in, result).finish();
}

}  // namespace umtet
