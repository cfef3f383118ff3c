#include "pipeline/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <map>
#include <sstream>

#include "pipeline/boundary_patches.h"
#include "pipeline/export_case.h"
#include "pipeline/version.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

constexpr const char* kFooter = R"(Examples:
  umtet run duck.ply -o duck                 from a scan to a certified mesh; run again: resumes, or does nothing
  umtet mesh duck --h 0.02                   another mesh size; the level set is not fitted again
  umtet mesh duck --max-deviation 0.001      flat faces at most so far from the surface
  umtet mesh --implicit 'x^2+y^2+z^2-1' --box -1.2,-1.2,-1.2,1.2,1.2,1.2 --tets 100000 -o ball
  umtet inspect duck.ply                     spacing, noise, normals, thickness; what is likely to go wrong
  umtet check part.msh                       validity and quality of any tet mesh
  umtet export duck --format inp,vtu         files for solvers, in duck/4-export
  umtet report duck                          duck/report.html: what a browser shows of it, offline
  umtet batch LIST -o scans --jobs 2         many scans; one table of verdicts, reasons and times
  umtet evolve --implicit '(x-t)^2+y^2+z^2-1' --box=-2,-2,-2,4,2,2 --h .1 --t 0:0.5:2 -o moving

Exit codes: 0 all well | 1 a bug of ours | 2 usage | 3 input refused | 4 reconstruction failed
  5 meshing not possible at this h | 6 made, but a gate or the certificate failed | 7 file trouble
  8 artefact corrupt | 9 resource limit | 130, 143 interrupted, resumable)";

/// Where CLI11 leaves what it read, as text; the table of parameters knows the types.
struct Inputs {
  std::string input, output, config, from, until, against, clouds, times, skip, other_case;
  std::vector<std::string> assignments, formats;
  std::map<std::string, std::string> values;  ///< by key
  std::map<std::string, bool> switches;       ///< by key
  bool force = false, strict = false, resume = false, no_report = false, quiet = false, verbose = false;
};

/// Help, choices and default of a parameter.
std::string described(const ParamField& f) {
  const std::string preset = preset_text(f);
  return f.help + (f.choices.empty() ? "" : fmt::format(" {{{}}}", fmt::join(f.choices, ","))) +
         (preset.empty() ? "" : fmt::format(" (default {})", preset));
}

class Parser {
 public:
  Parser();
  CommandLine parse(int argc, const char* const* argv);
  ProgramHelp help() const;

 private:
  CLI::App& add_command(const char* name, const char* description);
  CLI::Option& add_formats(CLI::App& command, const char* flag);
  void add_parameter_sources(CLI::App& command);
  void add_stage_flags(CLI::App& command);
  void add_timeout(CLI::App& command, const char* help);
  void add_batch();
  void add_parameter_flags(CLI::App& command, const std::vector<std::string>& sections,
                           const std::vector<std::string>& except = {});
  void check_command(int argc, const char* const* argv) const;
  [[noreturn]] void refuse(const CLI::ParseError& e, int argc, const char* const* argv) const;
  void finish(const CLI::App& command);
  void read_parameters();
  void finish_stages(const CLI::App& command);
  void finish_evolve();
  void finish_batch();
  void take_cloud();

  CLI::App app_{"umtet: from an oriented point cloud to a certified tetrahedral mesh", "umtet"};
  Inputs in_;
  CommandLine result_;
};

Parser::Parser() {
  app_.set_version_flag("--version", std::string("umtet ") + kVersion);
  app_.add_flag("--json", result_.json, "one JSON document on stdout, also on failure");
  app_.require_subcommand(1);
  app_.footer(kFooter);

  CLI::App& run = add_command("run", "All stages; those whose record matches are not run again");
  add_stage_flags(run);
  run.add_option("CLOUD", in_.input, "oriented points: .ply, .pcd, .xyz; or a case, to resume it");
  run.add_option("--from", in_.from, "first stage that may run: cloud, level-set, mesh");
  run.add_option("--until", in_.until, "last stage to run");
  add_formats(run, "--export");
  run.add_flag("--no-report", in_.no_report, "do not make report.html");
  add_parameter_flags(run, {"cloud", "reconstruct", "mesh", "output"}, {"mesh.implicit"});

  CLI::App& reconstruct = add_command("reconstruct", "Stage one only: the level set");
  add_stage_flags(reconstruct);
  reconstruct.add_option("CLOUD", in_.input, "oriented points; or a case, to fit again with other parameters");
  add_parameter_flags(
      reconstruct, {"cloud", "reconstruct", "output"},
      {"output.units", "output.min_quality", "output.label_names", "output.label_min_area", "output.patch_angle"});

  CLI::App& mesh = add_command("mesh", "Stage two only: from the level set of CASE, or from a formula");
  add_stage_flags(mesh);
  mesh.add_option("CASE", in_.input, "a case with a level set");
  add_formats(mesh, "--export");
  mesh.add_flag("--no-report", in_.no_report, "do not make report.html");
  add_parameter_flags(mesh, {"mesh", "output"});

  CLI::App& evolve = add_command("evolve", "A domain that moves: every instant meshed in one background mesh");
  add_parameter_sources(evolve);
  add_timeout(evolve, "seconds that all instants may take together; then exit 9");
  evolve.add_option("-o", in_.output, "the folder of the meshes");
  evolve.add_option("--clouds", in_.clouds, "a text file with the path of a cloud a line, instead of --implicit");
  evolve.add_option("--t", in_.times, "FROM:STEP:TO, the times; --implicit may have t in it");
  evolve.add_option("--skip", in_.skip, "times to leave out: --skip 3.1,3.4");
  add_parameter_flags(
      evolve, {"cloud", "reconstruct", "mesh", "output"},
      {"mesh.keep_iterates", "mesh.order", "output.label_names", "output.label_min_area", "output.patch_angle"});

  add_batch();

  CLI::App& inspect = add_command("inspect", "What is in a cloud, and what is likely to go wrong with it");
  inspect.add_option("CLOUD", in_.input, "points: .ply, .pcd, .xyz")->required();

  CLI::App& check = add_command("check", "Validity and quality of any tet mesh; exit 6 when it fails");
  check.add_option("MESH", in_.input, ".vtu, .msh or .mesh")->required();
  check.add_option("--against", in_.against, "a case whose surface the mesh should fit");
  add_parameter_sources(check);
  add_parameter_flags(check, {"output"},
                      {"output.max_memory", "output.label_names", "output.label_min_area", "output.patch_angle"});

  CLI::App& exports = add_command("export", "Files for solvers and viewers, in CASE/4-export");
  exports.add_option("CASE", in_.input, "a case with a mesh")->required();
  add_formats(exports, "--format").required();
  add_parameter_flags(exports, {"output"}, {"output.units", "output.max_memory", "output.min_quality"});

  CLI::App& report = add_command("report", "CASE/report.html: certificate, mesh and curves on one page, offline");
  report.add_option("CASE", in_.input, "a case with a certificate")->required();

  CLI::App& view = add_command("view", "CASE/5-view: psi on a grid, psi = 0 and a script for ParaView");
  view.add_option("CASE", in_.input, "a case with a mesh")->required();

  CLI::App& diff = add_command("diff", "The first stage in which two cases differ, and by how much each does");
  diff.add_option("CASE_A", in_.input, "a case")->required();
  diff.add_option("CASE_B", in_.other_case, "another")->required();
}

void Parser::add_batch() {
  CLI::App& batch = add_command("batch", "Many scans by the same parameters, each in a process of its own; one table");
  add_parameter_sources(batch);
  add_timeout(batch, "seconds that a scan may take; then it is a row with exit code 9");
  batch.add_option("LIST", in_.input, "a text file with the path of a cloud a line")->required();
  batch.add_option("-o", in_.output, "the folder of the cases and of batch.csv, batch.html");
  batch.add_option("--jobs", result_.batch.jobs, "scans at a time; they share the threads")->check(CLI::Range(1, 1024));
  batch.add_flag("--resume", in_.resume, "scans whose input or mesh was refused are not tried again");
  batch.add_flag("--force", in_.force, "run all stages although their records match");
  batch.add_flag("--strict", in_.strict, "a damaged artefact is exit 8 of its scan instead of being made again");
  add_formats(batch, "--export");
  add_parameter_flags(batch, {"cloud", "reconstruct", "mesh", "output"}, {"mesh.implicit"});
}

CLI::Option& Parser::add_formats(CLI::App& command, const char* flag) {
  return *command.add_option(flag, in_.formats, fmt::format("{}", fmt::join(export_formats(), ", ")))->delimiter(',');
}

CLI::App& Parser::add_command(const char* name, const char* description) {
  CLI::App& command = *app_.add_subcommand(name, description);
  command.add_flag("--json", result_.json, "one JSON document on stdout, also on failure");
  command.add_option("--threads", result_.threads, "number of threads; results do not depend on it")
      ->check(CLI::Range(1, 4096));
  command.add_flag("-q,--quiet", in_.quiet, "no messages but warnings and errors");
  command.add_flag("-v,--verbose", in_.verbose, "more messages");
  command
      .add_option_function<std::string>(
          "--progress",
          [this](const std::string& mode) {
            result_.progress = mode == "plain"  ? ProgressMode::Plain
                               : mode == "none" ? ProgressMode::None
                                                : ProgressMode::Auto;
          },
          "auto: a bar on a terminal; plain: lines; none")
      ->check(CLI::IsMember({"auto", "plain", "none"}));
  return command;
}

/// For the commands that take any parameter.
void Parser::add_parameter_sources(CLI::App& command) {
  command.add_option("--config", in_.config, "TOML file with parameters, such as the case.toml of another case");
  command.add_option("--set", in_.assignments, "any parameter: --set mesh.samples=10; see case.toml for all")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void Parser::add_timeout(CLI::App& command, const char* help) {
  // A timer of the system takes no more than a year without doubt.
  command.add_option("--timeout", result_.timeout, help)->check(CLI::Range(0., 3e7));
}

void Parser::add_stage_flags(CLI::App& command) {
  add_parameter_sources(command);
  add_timeout(command, "seconds that the run may take; then exit 9, resumable");
  command.add_option("-o", in_.output, "the folder of the case");
  command.add_flag("--force", in_.force, "run the stages although their records match");
  command.add_flag("--strict", in_.strict, "stop with exit 8 at a damaged artefact instead of making it again");
}

void Parser::add_parameter_flags(CLI::App& command, const std::vector<std::string>& sections,
                                 const std::vector<std::string>& except) {
  const auto holds = [](const std::vector<std::string>& list, const std::string& s) {
    return std::find(list.begin(), list.end(), s) != list.end();
  };
  for (const ParamField& f : params_fields()) {
    if (f.flag.empty() || !holds(sections, f.key.substr(0, f.key.find('.'))) || holds(except, f.key)) continue;
    if (std::holds_alternative<bool>(f.preset)) {
      command.add_flag(f.flag, in_.switches[f.key], f.help);
    } else {
      command.add_option(f.flag, in_.values[f.key], described(f))->type_name("");
    }
  }
}

/// Turns what CLI11 says into a UsageError that names the nearest flag or command.
void Parser::refuse(const CLI::ParseError& e, int argc, const char* const* argv) const {
  const std::vector<CLI::App*> parsed = app_.get_subcommands();
  if (parsed.empty()) {
    const char* const* flag = std::find_if(argv + 1, argv + argc, [](std::string_view a) { return a != "--json"; });
    throw UsageError(flag == argv + argc ? "no command; try umtet --help"
                                         : fmt::format("unknown flag {}; try umtet --help", *flag));
  }
  const CLI::App& command = *parsed.front();
  std::vector<std::string> flags;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) flags.push_back("--" + name);
    for (const std::string& name : option->get_snames()) flags.push_back("-" + name);
  }
  for (const std::string& extra : command.remaining()) {
    if (extra.size() < 2 || extra[0] != '-') continue;
    const std::string flag = extra.substr(0, extra.find('='));
    const std::string near = nearest(flag, flags);
    throw UsageError(fmt::format("{}: unknown flag {}{}", command.get_name(), flag,
                                 near.empty() ? "" : "; did you mean " + near + "?"));
  }
  throw UsageError(command.get_name() + ": " + e.what());
}

/// The first word must be a command, whatever flags are around it: CLI11 would answer any word with the general help.
void Parser::check_command(int argc, const char* const* argv) const {
  const char* const* word = std::find_if(argv + 1, argv + argc, [](const char* a) { return a[0] != '-'; });
  if (word == argv + argc) return;
  std::vector<std::string> commands;
  for (const CLI::App* c : app_.get_subcommands({})) commands.push_back(c->get_name());
  if (std::find(commands.begin(), commands.end(), *word) != commands.end()) return;
  const std::string near = nearest(*word, commands);
  throw UsageError(
      fmt::format("unknown command {}{}", *word, near.empty() ? "; try umtet --help" : "; did you mean " + near + "?"));
}

OptionHelp help_of(const CLI::Option& option) {
  OptionHelp help;
  for (const std::string& name : option.get_snames()) help.flags.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) help.flags.push_back("--" + name);
  help.is_flag = !help.flags.empty();
  if (!help.is_flag) help.flags.push_back(option.get_name());
  help.takes_value = option.get_items_expected_max() > 0;
  help.help = option.get_description();
  const std::string type = option.get_type_name();  // TEXT:{one,two} after CLI::IsMember
  if (const std::size_t brace = type.find('{'); brace != std::string::npos) {
    std::istringstream words(type.substr(brace + 1, type.find('}') - brace - 1));
    for (std::string word; std::getline(words, word, ',');) help.choices.push_back(word);
  }
  for (const ParamField& f : params_fields()) {
    if (!f.flag.empty() && f.flag == help.flags.back()) help.choices = f.choices;
  }
  return help;
}

ProgramHelp Parser::help() const {
  ProgramHelp program{app_.get_description(), app_.get_footer(), {}};
  for (const CLI::App* app : app_.get_subcommands({})) {
    CommandHelp& command = program.commands.emplace_back();
    command.name = app->get_name();
    command.help = app->get_description();
    for (const CLI::Option* option : app->get_options()) command.options.push_back(help_of(*option));
  }
  return program;
}

CommandLine Parser::parse(int argc, const char* const* argv) {
  if (argc > 1) check_command(argc, argv);
  try {
    app_.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    const std::vector<CLI::App*> parsed = app_.get_subcommands();
    result_.text = parsed.empty()
                       ? app_.help()
                       : fmt::format("umtet {}: {}", parsed.front()->get_name(), parsed.front()->help("umtet"));
    return result_;
  } catch (const CLI::CallForVersion& e) {
    result_.text = std::string(e.what()) + "\n";
    return result_;
  } catch (const CLI::ParseError& e) {
    refuse(e, argc, argv);
  }
  finish(*app_.get_subcommands().front());
  return std::move(result_);
}

void Parser::finish(const CLI::App& command) {
  result_.command = command.get_name();
  if (in_.quiet && in_.verbose) throw UsageError("-q and -v exclude each other");
  result_.verbosity = in_.quiet ? Verbosity::Quiet : in_.verbose ? Verbosity::Verbose : Verbosity::Normal;
  // The flags of all commands share their storage; only those of this one have been touched.
  Parameters& parameters = result_.request.parameters;
  for (const ParamField& f : params_fields()) {
    const CLI::Option* option = f.flag.empty() ? nullptr : command.get_option_no_throw(f.flag);
    if (!option || option->count() == 0) continue;
    const bool is_switch = std::holds_alternative<bool>(f.preset);
    parameters.set(f.key, is_switch ? (in_.switches[f.key] ? "true" : "false") : in_.values[f.key], ParamSource::Flag,
                   f.flag);
  }
  result_.formats = in_.formats;
  require_formats(result_.formats);
  parse_label_names(parameters.text("output.label_names"));
  if (result_.command == "check") {
    result_.action = CommandLine::Action::Check;
    result_.mesh = in_.input;
    if (!in_.against.empty()) result_.against = in_.against;
    read_parameters();
  } else if (result_.command == "inspect") {
    result_.action = CommandLine::Action::Inspect;
    result_.cloud = in_.input;
  } else if (result_.command == "export") {
    result_.action = CommandLine::Action::Export;
    result_.request.case_folder = in_.input;
    const fs::path toml = CasePaths{in_.input}.parameters();
    if (fs::exists(toml)) parameters.load(toml, ParamSource::Case);
    result_.formats = in_.formats;
  } else if (result_.command == "report") {
    result_.action = CommandLine::Action::Report;
    result_.request.case_folder = in_.input;
  } else if (result_.command == "view") {
    result_.action = CommandLine::Action::View;
    result_.request.case_folder = in_.input;
  } else if (result_.command == "diff") {
    result_.action = CommandLine::Action::Diff;
    result_.case_a = in_.input;
    result_.case_b = in_.other_case;
  } else if (result_.command == "evolve") {
    result_.action = CommandLine::Action::Evolve;
    finish_evolve();
  } else if (result_.command == "batch") {
    result_.action = CommandLine::Action::Batch;
    finish_batch();
  } else {
    result_.action = CommandLine::Action::Stages;
    finish_stages(command);
  }
}

/// --set and --config. A file may be about more than this command; --set and flags are refused where they would change
/// nothing.
void Parser::read_parameters() {
  Parameters& parameters = result_.request.parameters;
  for (const std::string& assignment : in_.assignments) parameters.set(assignment);
  for (const Stage stage : {Stage::Cloud, Stage::LevelSet, Stage::Mesh}) {
    const RunRequest& r = result_.request;
    const bool runs = result_.action != CommandLine::Action::Check;
    if (runs && stage >= r.from && stage <= r.until) continue;
    for (const ParamField& f : params_fields()) {
      if (f.key.starts_with(std::string(section_of(stage)) + ".") && parameters.source(f.key) >= ParamSource::Set) {
        throw UsageError(f.key + " belongs to a stage that this command does not run");
      }
    }
  }
  if (!in_.config.empty()) parameters.load(in_.config, ParamSource::File);
}

void Parser::finish_evolve() {
  if (in_.clouds.empty()) result_.request.from = Stage::Mesh;
  read_parameters();
  const bool formula = !result_.request.parameters.text("mesh.implicit").empty();
  if (formula != in_.clouds.empty()) throw UsageError("evolve: give --implicit EXPR with --box, or --clouds LIST");
  if (result_.request.parameters.integer("mesh.order") != 1) throw UsageError("evolve: mesh.order must be 1");
  if (in_.output.empty()) throw UsageError("evolve: -o FOLDER is missing");
  result_.evolve.folder = in_.output;
  result_.evolve.clouds = in_.clouds;
  result_.evolve.times = in_.times;
  result_.evolve.skip = in_.skip;
}

void Parser::finish_batch() {
  read_parameters();
  if (in_.output.empty()) throw UsageError("batch: -o FOLDER is missing");
  if (!result_.request.parameters.text("mesh.implicit").empty()) throw UsageError("batch: mesh.implicit is no scan");
  BatchRequest& batch = result_.batch;
  batch.list = in_.input;
  batch.folder = in_.output;
  batch.resume = in_.resume;
  batch.force = in_.force;
  batch.strict = in_.strict;
}

void Parser::finish_stages(const CLI::App& command) {
  const std::string name = command.get_name();
  RunRequest& request = result_.request;
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
    if (parameters.source("mesh.implicit") == ParamSource::Flag)
      throw UsageError("--implicit goes with -o, without CASE");
    if (!in_.output.empty() && fs::path(in_.output) != fs::path(in_.input)) {
      throw UsageError("-o " + in_.output + ": the case is " + in_.input + " already");
    }
    request.case_folder = in_.input;
    const fs::path toml = CasePaths{in_.input}.parameters();
    if (!fs::exists(toml)) throw UsageError(in_.input + " is not a case: it has no case.toml");
    parameters.load(toml, ParamSource::Case);
    if (request.from == Stage::Cloud && parameters.source("cloud.file") > ParamSource::Case) take_cloud();
    return;
  }
  if (in_.output.empty()) throw UsageError(name + ": -o CASE is missing");
  request.case_folder = in_.output;
  if (name == "mesh") {
    if (parameters.text("mesh.implicit").empty())
      throw UsageError("mesh: give a CASE, or --implicit EXPR with --box and -o");
    return;
  }
  if (!in_.input.empty()) parameters.set("cloud.file", in_.input, ParamSource::Flag, "command line");
  if (parameters.text("cloud.file").empty() && request.from == Stage::Cloud)
    throw UsageError(name + ": CLOUD is missing");
  if (request.from == Stage::Cloud) take_cloud();
}

/// The cloud that was named: to be read, and to be found again from another folder.
void Parser::take_cloud() {
  Parameters& parameters = result_.request.parameters;
  result_.request.source = parameters.text("cloud.file");
  parameters.make_absolute("cloud.file");
}

}  // namespace

CommandLine parse_command_line(int argc, const char* const* argv) { return Parser().parse(argc, argv); }

ProgramHelp program_help() { return Parser().help(); }

}  // namespace umtet
