#include "pipeline/cli/command_line.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <system_error>

#include "pipeline/case/version.h"
#include "pipeline/cli/detail/command_parser.h"
#include "pipeline/cli/help_format.h"
#include "pipeline/output/export_case.h"

namespace umtet {
namespace {

constexpr const char* kExamples =
    R"(  umtet run duck.ply                         from a scan to a certified mesh in duck/; a second call resumes
  umtet run scan.csv --columns x,y,z,-,nx,ny,nz -o scan    a table whose columns cannot be guessed
  umtet reconstruct duck.ply -o duck         the level set only; umtet mesh duck continues from it
  umtet mesh duck --h 0.02                   another mesh size; the level set is not fitted again
  umtet mesh duck --max-deviation 0.001      flat faces at most this far from the surface
  umtet mesh --implicit 'x^2+y^2+z^2-1' --box=-1.2,-1.2,-1.2,1.2,1.2,1.2 --tets 100000 -o ball
  umtet mesh --level-set sdf.vti -o part     a level set that another program computed
  umtet run mask.nii.gz --part 4 -o liver    part 4 of a segmentation; of an image: umtet run ct.nii.gz --level 300: -o bone
  umtet mesh duck --complement --box-walls --box=-2,-1.5,-2,4,2,2 --h .08    the fluid around the duck, in a box
  umtet evolve --implicit '(x-t)^2+y^2+z^2-1' --box=-2,-2,-2,4,2,2 --h .1 --t 0:0.5:2 -o moving
  umtet regions shell='x^2+y^2+z^2-1' core='x^2+y^2+z^2-.3' --box=-2,-2,-2,2,2,2 -o nested    several bodies in one mesh
  umtet batch LIST -o scans --jobs 2         many scans; one table of verdicts, reasons and times
  umtet inspect duck.ply                     spacing, noise, normals, thickness, likely problems
  umtet check part.msh                       validity and quality of any tet mesh
  umtet export duck --format inp,vtu         files for solvers, in duck/4-export
  umtet report duck                          duck/report.html: a page for the browser, offline
  umtet view duck                            then: paraview --script=duck/5-view/view.py
  umtet diff duck other                      the first stage that differs, and by how much
)";

/// Parameters that do not apply to scans, because psi is fitted to the scan.
const std::vector<std::string> kOwnPsi = {keys::mesh::implicit, keys::mesh::level_set, keys::mesh::level,
                                          keys::mesh::above,    keys::mesh::part,      keys::mesh::part_smooth};
/// Parameters of an image that is given in place of a cloud.
const std::vector<std::string> kOfImages = {keys::mesh::level, keys::mesh::above, keys::mesh::part,
                                            keys::mesh::part_smooth};

constexpr const char* kExitCodes = R"(
Exit codes: 0 success | 1 bug in umtet | 2 usage | 3 input refused | 4 reconstruction failed
  5 meshing not possible at this h | 6 mesh made, but a gate or the certificate failed | 7 file error
  8 artefact corrupt | 9 resource limit | 130, 143 interrupted, resumable)";

/// Returns the examples of all commands or of one command, followed by the exit codes.
std::string footer(const std::string& command = "") {
  std::string text = "Examples:\n", line;
  for (std::istringstream lines(kExamples); std::getline(lines, line);) {
    if (line.starts_with("  umtet " + command)) text += line + "\n";
  }
  return text + kExitCodes;
}

/// Returns the type of a value in the words of CLI11.
const char* type_of(const ParamField& f) {
  return std::holds_alternative<double>(f.preset)         ? "FLOAT"
         : std::holds_alternative<std::int64_t>(f.preset) ? "INT"
                                                          : "TEXT";
}

/// Returns help, choices and default of a parameter.
std::string described(const ParamField& f) {
  const std::string preset = preset_text(f);
  return f.help + (f.choices.empty() ? "" : fmt::format(" {{{}}}", fmt::join(f.choices, ","))) +
         (preset.empty() ? "" : fmt::format(" (default {})", preset));
}

}  // namespace

CommandParser::CommandParser() {
  app_.set_version_flag("--version", std::string("umtet ") + kVersion);
  app_.add_flag("--json", result_.options.json, "print one JSON document on stdout, also on failure");
  app_.require_subcommand(1);
  app_.footer(footer());

  CLI::App& run = add_command("run", make_run, "Run all stages; stages with a matching record are not repeated");
  add_stage_flags(run);
  run.add_option("CLOUD", in_.input,
                 "points: .ply, .pcd, text (.xyz, .csv ...); triangles: .stl, .obj, .off, .ply; image: .nii, .nrrd, "
                 ".vti, .vtk, also .gz; or a case to resume");
  run.add_option("--from", in_.from, "first stage to run: cloud, level-set, mesh (default cloud)");
  run.add_option("--until", in_.until, "last stage to run (default mesh)");
  add_formats(run, "--export");
  run.add_flag("--no-report", in_.no_report, "do not make report.html");
  add_parameter_flags(run, {"cloud", "reconstruct", "mesh", "output"}, {keys::mesh::implicit, keys::mesh::level_set});

  CLI::App& reconstruct = add_command("reconstruct", make_reconstruct, "Run stage one only: fit the level set");
  add_stage_flags(reconstruct);
  reconstruct.add_option("CLOUD", in_.input, "points or triangles; or a case to fit again with other parameters");
  add_parameter_flags(reconstruct, {"cloud", "reconstruct", "output"},
                      {keys::output::units, keys::output::min_quality, keys::output::accept, keys::output::label_names,
                       keys::output::label_min_area, keys::output::patch_angle, keys::output::patch_planar});

  CLI::App& mesh =
      add_command("mesh", make_mesh, "Run stage two only: mesh the level set of CASE, a formula, or a grid");
  add_stage_flags(mesh);
  mesh.add_option("CASE", in_.input, "a case with a level set");
  add_formats(mesh, "--export");
  mesh.add_flag("--no-report", in_.no_report, "do not make report.html");
  add_parameter_flags(mesh, {"mesh", "output"});

  CLI::App& evolve = add_command("evolve", make_evolve, "Mesh a moving domain: all instants in one background mesh");
  add_parameter_sources(evolve);
  add_timeout(evolve, "maximum seconds for all instants together; then exit 9");
  evolve.add_option("-o", in_.output, "folder for the meshes");
  evolve.add_option("--clouds", in_.clouds, "text file with one path of a cloud per line, instead of --implicit");
  evolve.add_option("--t", in_.times, "times, as FROM:STEP:TO; --implicit may contain t");
  evolve.add_option("--skip", in_.skip, "times to leave out: --skip 3.1,3.4");
  add_parameter_flags(
      evolve, {"cloud", "reconstruct", "mesh", "output"},
      {keys::mesh::level_set, keys::mesh::level, keys::mesh::above, keys::mesh::part, keys::mesh::part_smooth,
       keys::mesh::keep_iterates, keys::mesh::order, keys::mesh::effort, keys::output::label_names,
       keys::output::label_min_area, keys::output::patch_angle, keys::output::patch_planar});

  CLI::App& regions =
      add_command("regions", make_regions,
                  "Make one mesh of several bodies that share their interfaces, and of what is around them");
  regions
      .add_option("BODY", in_.bodies,
                  "NAME=FORMULA, the body where the formula is negative, or NAME=FILE of points or triangles; later "
                  "bodies cover earlier ones. Or IMAGE, whose labels are the regions")
      ->required();
  regions.add_option("-o", in_.output, "folder for regions.vtu and regions.json");
  add_formats(regions, "--export");
  regions.add_flag("--least", in_.least, "a point belongs to the body whose formula is least, not to the last one");
  regions.add_flag("--periodic", in_.periodic, "the box is one period: opposite sides of the mesh match");
  regions.add_flag("--no-outside", in_.no_outside, "mesh the bodies alone, not the rest of the box");
  add_parameter_sources(regions);
  for (const ParamField& f : params_fields())
    if (f.key == keys::mesh::box || f.key == keys::mesh::h || f.key == keys::mesh::tets ||
        f.key == keys::output::label_names)
      add_value(regions, f);

  add_batch();

  CLI::App& inspect = add_command("inspect", make_inspect,
                                  "Report the contents of a cloud, an image or a formula, and likely problems");
  inspect.add_option(
      "CLOUD", in_.input,
      "points: .ply, .pcd, text (.xyz, .csv ...); triangles: .stl, .obj, .off, .ply; image: .nii, .nrrd, "
      ".vti, .vtk, also .gz; or --implicit with --box");
  add_parameter_sources(inspect);
  for (const ParamField& f : params_fields()) {  // the reading of a file, and the prediction
    if (f.key == keys::cloud::columns || f.key == keys::cloud::features || f.key == keys::reconstruct::edges ||
        f.key == keys::reconstruct::feature_angle || f.key == keys::mesh::h || f.key == keys::mesh::tets ||
        f.key == keys::mesh::max_tets || f.key == keys::mesh::implicit || f.key == keys::mesh::box)
      add_value(inspect, f);
    if (std::find(kOfImages.begin(), kOfImages.end(), f.key) == kOfImages.end()) continue;
    if (std::holds_alternative<bool>(f.preset)) {
      inspect.add_flag(f.flag, in_.switches[f.key], f.help);
    } else {
      add_value(inspect, f);
    }
  }

  CLI::App& check =
      add_command("check", make_check, "Check validity and quality of any tet mesh; exit 6 if the check fails");
  check.add_option("MESH", in_.input, ".vtu, .msh, .mesh or .inp")->required();
  check.add_option("--against", in_.against, "case whose surface the mesh should fit");
  add_parameter_sources(check);
  add_parameter_flags(check, {"output"},
                      {keys::output::max_memory, keys::output::label_names, keys::output::label_min_area,
                       keys::output::patch_angle, keys::output::patch_planar});

  CLI::App& exports = add_command("export", make_export, "Write files for solvers and viewers to CASE/4-export");
  exports.add_option("CASE", in_.input, "a case with a mesh, or a folder of umtet regions")->required();
  add_formats(exports, "--format").required();
  add_parameter_flags(exports, {"output"},
                      {keys::output::units, keys::output::max_memory, keys::output::min_quality, keys::output::strict,
                       keys::output::accept});
  add_fresh(exports, "take patches and names from this call alone, not from former calls");

  CLI::App& report =
      add_command("report", make_report, "Write CASE/report.html: certificate, stages and curves on one page, offline");
  report.add_option("CASE", in_.input, "a case with at least one stage")->required();

  CLI::App& view =
      add_command("view", make_view, "Write CASE/5-view: psi on a grid, psi = 0 and a script for ParaView");
  view.add_option("CASE", in_.input, "a case with a mesh")->required();

  CLI::App& diff = add_command("diff", make_diff,
                               "Report the first stage in which two cases differ, and the differences of each stage");
  diff.add_option("CASE_A", in_.input, "first case")->required();
  diff.add_option("CASE_B", in_.other_case, "second case")->required();
  diff.add_option("-o", in_.output, "page with the picture (default: diff.html in the second case)");
  group_flags(app_);
}

void CommandParser::add_batch() {
  CLI::App& batch =
      add_command("batch", make_batch,
                  "Run many scans with the same parameters on one machine, each in its own process; write one table");
  add_parameter_sources(batch);
  add_timeout(batch, "maximum seconds per scan; then its row has exit code 9");
  batch.add_option("LIST", in_.input, "text file with one path of a cloud per line")->required();
  batch.add_option("-o", in_.output, "folder for the cases and for batch.csv, batch.html");
  batch.add_option("--jobs", in_.jobs, "number of scans at a time; they share the threads (default 1)")
      ->check(CLI::Range(1, 1024, "1 to 1024"));
  batch.add_flag("--resume", in_.resume, "do not repeat scans whose input or mesh was refused");
  batch.add_flag("--collect", in_.collect,
                 "run nothing; write the tables from the results of other machines in the folder (examples/cluster)");
  batch.add_flag("--force", in_.force, "run all stages, even if their records match");
  add_formats(batch, "--export");
  add_parameter_flags(batch, {"cloud", "reconstruct", "mesh", "output"}, kOwnPsi);
}

CLI::Option& CommandParser::add_formats(CLI::App& command, const char* flag) {
  return *command.add_option(flag, in_.formats, fmt::format("{}", fmt::join(export_formats(), ", ")))->delimiter(',');
}

CLI::App& CommandParser::add_command(const char* name, CommandMaker make, const char* description) {
  CLI::App& command = *app_.add_subcommand(name, description);
  command.footer(footer(std::string(name) + " "));
  command.callback([this, &command, make] {
    if (in_.quiet && in_.verbose) throw UsageError("-q and -v are mutually exclusive");
    CommonOptions& options = result_.options;
    options.verbosity = in_.quiet ? Verbosity::Quiet : in_.verbose ? Verbosity::Verbose : Verbosity::Normal;
    result_.name = command.get_name();
    result_.command = make(command, in_);
  });
  command.add_flag("--json", result_.options.json, "print one JSON document on stdout, also on failure");
  command
      .add_option("--threads", result_.options.threads,
                  "number of threads; results do not depend on it (default: all processors)")
      ->check(CLI::Range(1, 4096, "1 to 4096"));
  command.add_flag("-q,--quiet", in_.quiet, "print only warnings and errors");
  command.add_flag("-v,--verbose", in_.verbose, "print more messages");
  command
      .add_option_function<std::string>(
          "--progress",
          [this](const std::string& mode) {
            result_.options.progress = mode == "plain"  ? ProgressMode::Plain
                                       : mode == "none" ? ProgressMode::None
                                                        : ProgressMode::Auto;
          },
          "auto: a bar on a terminal, otherwise lines; plain: lines; none (default auto)")
      ->check(CLI::IsMember({"auto", "plain", "none"}));
  return command;
}

/// Adds the flags of commands that accept any parameter.
void CommandParser::add_parameter_sources(CLI::App& command) {
  command.add_option("--config", in_.config, "TOML file with parameters, such as the case.toml of another case");
  command.add_option("--set", in_.assignments, "set any parameter: --set mesh.samples=10; case.toml lists all")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void CommandParser::add_timeout(CLI::App& command, const char* help) {
  // The timer of the system supports about a year for certain.
  command.add_option("--timeout", result_.options.timeout, help)->check(CLI::Range(0., 3e7, "0 to 3e7"));
}

void CommandParser::add_stage_flags(CLI::App& command) {
  add_parameter_sources(command);
  add_timeout(command, "maximum seconds for the run; then exit 9, resumable");
  command.add_option("-o", in_.output, "folder of the case (default: the file name without its extension)");
  command.add_flag("--force", in_.force, "run the stages, even if their records match");
  add_fresh(command,
            "take only the input of the case from former calls; parameters that this call does not set have their "
            "defaults; stages that match are not repeated");
}

void CommandParser::add_fresh(CLI::App& command, const char* help) { command.add_flag("--fresh", in_.fresh, help); }

void CommandParser::add_value(CLI::App& command, const ParamField& field) {
  command.add_option(field.flag, in_.values[field.key], described(field))->type_name(type_of(field));
}

void CommandParser::add_parameter_flags(CLI::App& command, const std::vector<std::string>& sections,
                                        const std::vector<std::string>& except) {
  const auto holds = [](const std::vector<std::string>& list, const std::string& s) {
    return std::find(list.begin(), list.end(), s) != list.end();
  };
  for (const ParamField& f : params_fields()) {
    if (f.flag.empty() || !holds(sections, f.key.substr(0, f.key.find('.'))) || holds(except, f.key)) continue;
    if (std::holds_alternative<bool>(f.preset)) {
      command.add_flag(f.flag, in_.switches[f.key], f.help);
    } else {
      add_value(command, f);
    }
  }
}

/// Converts an error of CLI11 into a UsageError that names the nearest flag or command.
void CommandParser::refuse(const CLI::ParseError& e, int argc, const char* const* argv) const {
  const std::vector<CLI::App*> parsed = app_.get_subcommands();
  if (parsed.empty()) {
    const char* const* flag = std::find_if(argv + 1, argv + argc, [](std::string_view a) { return a != "--json"; });
    throw UsageError(flag == argv + argc ? "no command given; try umtet --help"
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
    std::vector<std::string> others;
    for (const CLI::App* other : app_.get_subcommands({})) {
      if (other->get_option_no_throw(flag)) others.push_back("umtet " + other->get_name());
    }
    const std::string near = nearest(flag, flags);
    throw UsageError(fmt::format("{}: unknown flag {}{}", command.get_name(), flag,
                                 !others.empty() ? fmt::format("; it is a flag of {}", fmt::join(others, ", "))
                                 : near.empty()  ? ""
                                                 : "; did you mean " + near + "?"));
  }
  throw UsageError(command.get_name() + ": " + e.what());
}

/// Checks that the first word is a command, whatever flags surround it: CLI11 would answer any word with the
/// general help.
void CommandParser::check_command(int argc, const char* const* argv) const {
  const char* const* word = std::find_if(argv + 1, argv + argc, [](const char* a) { return a[0] != '-'; });
  if (word == argv + argc) return;
  std::vector<std::string> commands;
  for (const CLI::App* c : app_.get_subcommands({})) commands.push_back(c->get_name());
  if (std::find(commands.begin(), commands.end(), *word) != commands.end()) return;
  std::string near = nearest(*word, commands);
  std::error_code unknown;
  if (std::filesystem::exists(*word, unknown))
    near = std::string("umtet run ") + *word;  // the word names a cloud or a case
  throw UsageError(
      fmt::format("unknown command {}{}", *word, near.empty() ? "; try umtet --help" : "; did you mean " + near + "?"));
}

namespace {

/// Returns the words of the call in reverse order, as CLI11 expects them. After "--box=", CLI11 would look for the
/// value in the next word, so an empty word is inserted.
std::vector<std::string> words_of(int argc, const char* const* argv) {
  std::vector<std::string> words;
  for (int k = 1; k < argc; ++k) {
    std::string word = argv[k];
    const bool clears = std::any_of(params_fields().begin(), params_fields().end(), [&](const ParamField& f) {
      return !f.flag.empty() && !std::holds_alternative<bool>(f.preset) && word == f.flag + "=";
    });
    if (clears) word.pop_back();
    words.push_back(std::move(word));
    if (clears) words.emplace_back();
  }
  std::reverse(words.begin(), words.end());
  return words;
}

}  // namespace

CommandLine CommandParser::parse(int argc, const char* const* argv) {
  if (argc > 1) check_command(argc, argv);
  try {
    app_.parse(words_of(argc, argv));  // calls the maker of the command
  } catch (const CLI::CallForHelp&) {
    const std::vector<CLI::App*> parsed = app_.get_subcommands();
    result_.command = TextAnswer{
        parsed.empty() ? app_.help()
                       : fmt::format("umtet {}: {}", parsed.front()->get_name(), parsed.front()->help("umtet"))};
  } catch (const CLI::CallForVersion& e) {
    result_.command = TextAnswer{std::string(e.what()) + "\n"};
  } catch (const CLI::ParseError& e) {
    refuse(e, argc, argv);
  }
  return std::move(result_);
}

CommandLine parse_command_line(int argc, const char* const* argv) { return CommandParser().parse(argc, argv); }

}  // namespace umtet
