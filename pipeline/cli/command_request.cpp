// Converts the words of a call into requests, one function per command.

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <utility>

#include "body/fidelity/accepted_defects.h"
#include "pipeline/case/case_folder.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/cli/command_line.h"
#include "pipeline/cli/detail/command_parser.h"
#include "pipeline/domain/body_options.h"
#include "pipeline/output/boundary_patches.h"
#include "pipeline/output/export_case.h"
#include "reconstruct/io/grid_io.h"
#include "reconstruct/io/input_file.h"
#include "reconstruct/io/point_cloud_io.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

/// Returns the parameters that the flags of this command set. All commands share the storage of their flags; only
/// the flags of this command can have been set.
Parameters flag_parameters(const CLI::App& app, const CommandInputs& in) {
  Parameters parameters;
  for (const ParamField& f : params_fields()) {
    const CLI::Option* option = f.flag.empty() ? nullptr : app.get_option_no_throw(f.flag);
    if (!option || option->count() == 0) continue;
    const bool is_switch = std::holds_alternative<bool>(f.preset);
    parameters.set(f.key, is_switch ? (in.switches.at(f.key) ? "true" : "false") : in.values.at(f.key),
                   ParamSource::Flag, f.flag);
  }
  require_formats(in.formats);
  parse_label_names(parameters.output().label_names);
  return parameters;
}

/// Adds --set and --config. A file may contain parameters of other commands; --set and flags are refused if they
/// would have no effect.
/// @param runs  returns whether the command runs this stage
template <class F>
void read_parameters(const CommandInputs& in, const F& runs, Parameters& parameters) {
  for (const std::string& assignment : in.assignments) parameters.set(assignment);
  for (const Stage stage : kStages) {
    if (runs(stage)) continue;
    for (const ParamField& f : params_fields()) {
      if (f.key.starts_with(std::string(section_of(stage)) + ".") && parameters.source(f.key) >= ParamSource::Set) {
        throw UsageError(f.key + " belongs to a stage that this command does not run");
      }
    }
  }
  if (!in.config.empty()) parameters.load(in.config, ParamSource::File);
  parse_accepted_defects(parameters.output().accept);
  if (const std::string problem = problem_of_columns(parameters.cloud().columns); !problem.empty())
    throw UsageError(fmt::format("--columns {}: {}", parameters.cloud().columns, problem));
}

/// Takes the cloud that the call names. Its path becomes absolute so that it is found from other folders.
void take_cloud(RunRequest& request) {
  request.source = request.parameters.cloud().file;
  request.parameters.make_cloud_absolute();
}

/// Returns the default case of a file: its stem, in the current folder.
/// \throw UsageError  the stem is a file, a folder with other contents, or the case of another file
fs::path default_case(const fs::path& source) {
  fs::path stem = source.stem();
  if (source.extension() == ".gz") stem = stem.stem();  // mask.nii.gz
  const auto refuse = [](const std::string& why) { throw UsageError("-o CASE is missing: " + why); };
  if (source.empty()) refuse("no input file is given");
  if (stem.empty() || stem.string().front() == '.') refuse(source.string() + " has no name for the case");
  std::error_code unknown;
  if (!fs::exists(stem, unknown)) return stem;
  const CasePaths paths{stem};
  if (!fs::is_directory(stem)) refuse(stem.string() + " is a file");
  if (!fs::exists(paths.parameters())) {
    if (!fs::is_empty(stem)) refuse(stem.string() + " is a folder but not a case");
    return stem;
  }
  Parameters former;
  try {
    former.load(paths.parameters(), ParamSource::Case);
  } catch (const ArtefactDamaged&) {
    return stem;  // the run reports the damage
  }
  const std::string& cloud = former.cloud().file;
  const fs::path of_case = cloud.empty() ? fs::path(former.mesh().level_set) : fs::path(cloud);
  if (fs::weakly_canonical(of_case) != fs::weakly_canonical(source))
    refuse(fmt::format("{} is the case of {}", stem.string(), of_case.empty() ? "a formula" : of_case.string()));
  return stem;
}

/// Adds the parameters that the case has from former calls; with `fresh`, only those that define its input.
void take_case(const fs::path& toml, bool fresh, Parameters& parameters) {
  if (!fresh) return parameters.load(toml, ParamSource::Case);
  Parameters former;
  former.load(toml, ParamSource::Case);
  parameters.take_body(former);
}

/// \throw UsageError if parameters of images are set but there is no image
void require_image(const Parameters& parameters) {
  if (!parameters.mesh().level_set.empty()) return;
  for (const char* key : {keys::mesh::level, keys::mesh::above, keys::mesh::part, keys::mesh::part_smooth}) {
    if (parameters.source(key) >= ParamSource::Set)
      throw UsageError(std::string(key) + " applies only to images and segmentations (.nii, .nrrd, .vti, .vtk)");
  }
}

/// Takes the image that the call names. An image needs only the mesh stage. Its path becomes absolute so that it is
/// found from other folders.
void take_image(const std::string& input, RunRequest& request) {
  if (request.until != Stage::Mesh)
    throw UsageError(input + " is an image, which needs only the mesh stage (umtet run)");
  request.parameters.set(keys::mesh::level_set, fs::absolute(input).lexically_normal().string(), ParamSource::Flag,
                         "command line");
  request.from = Stage::Mesh;
}

/// Makes the command that runs the stages first..last, or the stages between --from and --until, of the given case
/// or cloud.
/// @param input_is_case  the given word is a case, not a cloud
Command make_stages(const CLI::App& app, const CommandInputs& in, Stage first, Stage last, bool input_is_case) {
  RunRequest request;
  request.parameters = flag_parameters(app, in);
  Parameters& parameters = request.parameters;
  request.force = in.force;
  request.fresh = in.fresh;
  request.report = !in.no_report;
  request.from = in.from.empty() ? first : parse_stage(in.from);
  request.until = in.until.empty() ? last : parse_stage(in.until);
  if (!in.formats.empty() && request.until != Stage::Mesh)
    throw UsageError("--export needs a mesh, but --until stops before the mesh");
  if (request.from > request.until) throw UsageError("--from " + in.from + " is after --until " + in.until);

  read_parameters(
      in, [&](Stage stage) { return stage >= request.from && stage <= request.until; }, parameters);
  // The criteria of the verdict are stored with the case, but each call decides whether damage stops the run.
  request.strict = parameters.output().strict && parameters.source(keys::output::strict) >= ParamSource::Set;
  if (input_is_case) {
    if (parameters.source(keys::mesh::implicit) == ParamSource::Flag)
      throw UsageError("--implicit needs -o instead of CASE");
    if (parameters.source(keys::mesh::level_set) == ParamSource::Flag)
      throw UsageError("--level-set needs -o instead of CASE");
    if (!in.output.empty() && fs::path(in.output) != fs::path(in.input)) {
      throw UsageError("-o " + in.output + ": the call already names the case " + in.input);
    }
    request.case_folder = in.input;
    const fs::path toml = CasePaths{in.input}.parameters();
    if (!fs::exists(toml)) throw UsageError(in.input + " is not a case: it contains no case.toml");
    take_case(toml, in.fresh, parameters);
    if (request.from == Stage::Cloud && parameters.source(keys::cloud::file) > ParamSource::Case) take_cloud(request);
  } else {
    const std::string name = app.get_name();
    request.case_folder = in.output;
    std::shared_ptr<const InputFile> input;
    if (fs::is_regular_file(in.input)) input = std::make_shared<InputFile>(in.input);
    if (input && is_grid_file(*input)) {
      take_image(in.input, request);
    } else if (first == Stage::Mesh) {
      if (!has_own_psi(parameters.mesh()))
        throw UsageError("mesh: give a CASE, or --implicit EXPR with --box and -o, or --level-set GRID with -o");
    } else {
      if (!in.input.empty()) parameters.set(keys::cloud::file, in.input, ParamSource::Flag, "command line");
      if (parameters.cloud().file.empty() && request.from == Stage::Cloud)
        throw UsageError(name + ": CLOUD is missing");
      if (request.from == Stage::Cloud) take_cloud(request);
      if (input && request.source == input->path()) request.input = std::move(input);
    }
    if (in.output.empty()) {
      const std::string& grid = parameters.mesh().level_set;
      if (first == Stage::Mesh && grid.empty()) throw UsageError("-o CASE is missing: a formula has no file name");
      request.case_folder = default_case(grid.empty() ? parameters.cloud().file : grid);
    }
  }
  require_image(parameters);
  require_walls(parameters);
  require_graded(parameters);
  return RunCommand{std::move(request), in.formats};
}

bool is_folder(const std::string& input) { return !input.empty() && fs::is_directory(input); }

}  // namespace

Command make_run(const CLI::App& app, const CommandInputs& in) {
  return make_stages(app, in, Stage::Cloud, Stage::Mesh, is_folder(in.input));
}

Command make_reconstruct(const CLI::App& app, const CommandInputs& in) {
  const bool again = is_folder(in.input);
  return make_stages(app, in, again ? Stage::LevelSet : Stage::Cloud, Stage::LevelSet, again);
}

Command make_mesh(const CLI::App& app, const CommandInputs& in) {
  return make_stages(app, in, Stage::Mesh, Stage::Mesh, !in.input.empty());
}

Command make_evolve(const CLI::App& app, const CommandInputs& in) {
  EvolveRequest request;
  request.parameters = flag_parameters(app, in);
  const bool of_clouds = !in.clouds.empty();
  read_parameters(
      in, [&](Stage stage) { return of_clouds || stage == Stage::Mesh; }, request.parameters);
  const bool formula = !request.parameters.mesh().implicit.empty();
  if (!request.parameters.mesh().level_set.empty()) throw UsageError("evolve: mesh.level_set cannot change with time");
  if (formula == of_clouds) throw UsageError("evolve: give --implicit EXPR with --box, or --clouds LIST");
  if (request.parameters.mesh().order != 1) throw UsageError("evolve: mesh.order must be 1");
  if (in.output.empty()) throw UsageError("evolve: -o FOLDER is missing");
  request.folder = in.output;
  request.clouds = in.clouds;
  request.times = in.times;
  request.skip = in.skip;
  require_walls(request.parameters);
  require_graded(request.parameters);
  return EvolveCommand{std::move(request)};
}

Command make_batch(const CLI::App& app, const CommandInputs& in) {
  BatchRequest request;
  request.parameters = flag_parameters(app, in);
  read_parameters(
      in, [](Stage) { return true; }, request.parameters);
  if (in.output.empty()) throw UsageError("batch: -o FOLDER is missing");
  if (has_own_psi(request.parameters.mesh())) throw UsageError("batch: mesh.implicit and mesh.level_set are not scans");
  request.list = in.input;
  request.folder = in.output;
  request.formats = in.formats;
  request.jobs = in.jobs;
  request.resume = in.resume;
  request.collect = in.collect;
  if (in.collect && (in.force || in.resume))
    throw UsageError("batch: --collect runs nothing, so --force and --resume do not apply");
  request.force = in.force;
  require_walls(request.parameters);
  return BatchCommand{std::move(request)};
}

Command make_regions(const CLI::App& app, const CommandInputs& in) {
  RegionsRequest request;
  request.parameters = flag_parameters(app, in);
  read_parameters(
      in, [](Stage) { return true; }, request.parameters);
  if (in.bodies.size() == 1 && is_file(in.bodies[0])) {
    request.image = in.bodies[0];
  } else {
    for (const std::string& body : in.bodies) request.bodies.push_back(named_source(body));
  }
  request.has_outside = !in.no_outside;
  request.is_periodic = in.periodic;
  request.overlap = in.least ? Overlap::Least : Overlap::Later;
  if (in.output.empty()) throw UsageError("regions: -o FOLDER is missing");
  request.folder = in.output;
  require_formats_of_regions(in.formats);
  return RegionsCommand{std::move(request), in.formats};
}

Command make_inspect(const CLI::App& app, const CommandInputs& in) {
  InspectCommand command{in.input, flag_parameters(app, in)};
  read_parameters(
      in, [](Stage) { return true; }, command.parameters);
  if (in.input.empty() == command.parameters.mesh().implicit.empty())
    throw UsageError("inspect: give a file, or --implicit EXPR with --box");
  return command;
}

Command make_check(const CLI::App& app, const CommandInputs& in) {
  CheckCommand command{in.input, {}, flag_parameters(app, in)};
  if (!in.against.empty()) command.against = in.against;
  read_parameters(
      in, [](Stage) { return false; }, command.parameters);
  require_walls(command.parameters);
  return command;
}

Command make_export(const CLI::App& app, const CommandInputs& in) {
  ExportCommand command{in.input, in.formats, flag_parameters(app, in), in.fresh};
  const fs::path toml = CasePaths{in.input}.parameters();
  if (fs::exists(toml)) {
    Parameters former;
    former.load(toml, ParamSource::Case);
    if (in.fresh) {
      for (const Stage stage : kStages) command.parameters.copy_section(section_of(stage), former);
    } else {
      command.parameters.load(toml, ParamSource::Case);
    }
    command.changed = differences("output", former.section("output"), command.parameters.section("output"));
  }
  require_walls(command.parameters);
  return command;
}

Command make_report(const CLI::App&, const CommandInputs& in) { return ReportCommand{in.input}; }

Command make_view(const CLI::App&, const CommandInputs& in) { return ViewCommand{in.input}; }

Command make_diff(const CLI::App&, const CommandInputs& in) { return DiffCommand{in.input, in.other_case, in.output}; }

}  // namespace umtet
