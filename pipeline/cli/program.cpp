#include "pipeline/cli/program.h"

#include <fmt/format.h>
#include <malloc.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>
#include <variant>

#include "pipeline/case/exit_code.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/case/memory.h"
#include "pipeline/case/stop_document.h"
#include "pipeline/cli/command_line.h"
#include "pipeline/meshing/check.h"
#include "pipeline/meshing/part_mesher.h"
#include "pipeline/output/case_diff.h"
#include "pipeline/output/diff_page.h"
#include "pipeline/output/export_case.h"
#include "pipeline/output/inspect.h"
#include "pipeline/output/inspect_formula.h"
#include "pipeline/output/inspect_image.h"
#include "pipeline/output/report.h"
#include "pipeline/output/view_files.h"
#include "pipeline/reports/certificate_json.h"
#include "pipeline/reports/certificate_summary.h"
#include "pipeline/run/evolve.h"
#include "pipeline/run/run.h"
#include "pipeline/stages/scan_source.h"
#include "pipeline/stages/stale_mesh.h"
#include "reconstruct/io/grid_io.h"
#include "reconstruct/io/input_file.h"

namespace umtet {
namespace {

/// The output to stdout: lines for people, or one document for programs.
struct Output {
  ExitCode code = ExitCode::Success;
  std::string text;
  Json document = Json::object();
};

std::string file_list(const std::vector<std::filesystem::path>& files) {
  std::string out;
  for (const auto& file : files) out += (out.empty() ? "files     " : "          ") + file.string() + "\n";
  return out;
}

/// Returns a line with the mesh, its report and the exports.
std::string main_files(const RunRequest& request, const RunOutcome& outcome) {
  const CasePaths paths{request.case_folder};
  std::string line = "files     " + paths.mesh().string();
  for (const auto& file : outcome.files) {
    const bool is_export = file.parent_path() == paths.exports();
    if (is_export || file == paths.report()) line += ", " + file.string();
  }
  return line + "\n";
}

Json names(const std::vector<std::filesystem::path>& files) {
  Json list = Json::array();
  for (const auto& file : files) list.push_back(file.string());
  return list;
}

Output output_of_files(const std::vector<std::filesystem::path>& files) {
  return {ExitCode::Success, file_list(files), {{"files", names(files)}}};
}

std::vector<std::filesystem::path> exports_of(const CasePaths& paths, const std::vector<std::string>& formats,
                                              const Parameters& parameters, Progress& progress,
                                              const MeshWithBoundary* parts = nullptr) {
  set_work_at_hand("export");
  const CaseLock lock(paths.root);
  return export_case(paths, formats, parameters, progress, parts);
}

void require_case(const std::filesystem::path& folder) {
  if (!std::filesystem::exists(folder)) throw UsageError(folder.string() + ": no such case");
}

/// Executes a command and returns its output to stdout.
struct Execution {
  const CommonOptions& options;
  Progress& progress;
  const RanksOfProgram& ranks;

  Output operator()(const TextAnswer& command) const { return {ExitCode::Success, command.text, {}}; }
  Output operator()(RunCommand& command) const;
  Output operator()(EvolveCommand& command) const;
  Output operator()(RegionsCommand& command) const;
  Output operator()(BatchCommand& command) const;
  Output operator()(const InspectCommand& command) const;
  Output operator()(const CheckCommand& command) const;
  Output operator()(const ExportCommand& command) const;
  Output operator()(const ReportCommand& command) const;
  Output operator()(const ViewCommand& command) const;
  Output operator()(const DiffCommand& command) const;
  std::shared_ptr<const MeshWithBoundary> parts_of(const ExportCommand& command) const;
};

Output Execution::operator()(RunCommand& command) const {
  RunRequest& request = command.request;
  request.threads = options.threads;
  if (!for_one_process(request.parameters)) request.ranks = ranks.mesher;
  request.keeps_parts = takes_parts(command.formats);
  request.needs_parts = is_in_pieces(command.formats);
  RunOutcome outcome = run_case(request, progress);
  if (!command.formats.empty()) {
    const CasePaths paths{request.case_folder, {}, request.stamps};
    for (auto& file : exports_of(paths, command.formats, request.parameters, progress, outcome.parts.get())) {
      outcome.files.push_back(std::move(file));
    }
  }
  progress.clear();
  if (outcome.stages_run.empty()) {
    progress.say(fmt::format("nothing to do: {} is up to date", request.case_folder.string()));
  }
  Json stages = Json::array();
  for (const Stage stage : outcome.stages_run) stages.push_back(to_string(stage));
  Output output;
  output.code = outcome.code;
  output.document = {{"case", request.case_folder.string()},
                     {"stages_run", stages},
                     {"kept", outcome.kept},
                     {"changed", outcome.changed},
                     {"files", names(outcome.files)},
                     {"certificate", outcome.certificate ? to_json(*outcome.certificate) : Json(nullptr)}};
  if (options.verbosity == Verbosity::Quiet) return output;
  const bool is_long = options.verbosity == Verbosity::Verbose;
  if (outcome.certificate) output.text = is_long ? summary(*outcome.certificate) : short_summary(*outcome.certificate);
  output.text += is_long || !outcome.certificate ? file_list(outcome.files) : main_files(request, outcome);
  return output;
}

Output Execution::operator()(const CheckCommand& command) const {
  set_work_at_hand("check");
  const MeshCheck found = check_mesh(command.mesh, command.against, command.parameters, progress);
  progress.clear();
  return {
      found.verdict.passes() ? ExitCode::Success : ExitCode::GateFailed, summary(found), {{"check", to_json(found)}}};
}

Output Execution::operator()(const InspectCommand& command) const {
  set_work_at_hand("inspect");
  if (command.cloud.empty()) {
    const FormulaInspection found = inspect_formula(command.parameters, progress);
    progress.clear();
    return {ExitCode::Success, inspection_text(found), {{"inspection", to_json(found)}}};
  }
  const std::shared_ptr<const InputFile> input = open_source(command.cloud);
  if (is_grid_file(*input)) {
    const ImageInspection found = inspect_image(command.cloud, command.parameters, progress);
    progress.clear();
    return {ExitCode::Success, inspection_text(found), {{"inspection", to_json(found)}}};
  }
  const CloudInspection found = inspect_cloud(*input, command.parameters, progress);
  progress.clear();
  return {ExitCode::Success, inspection_text(found), {{"inspection", to_json(found)}}};
}

Output Execution::operator()(EvolveCommand& command) const {
  set_work_at_hand("evolve");
  command.request.threads = options.threads;
  if (!for_one_process(command.request.parameters)) command.request.ranks = ranks.mesher;
  const EvolveOutcome outcome = evolve(command.request, progress);
  progress.clear();
  return {outcome.code,
          outcome.text + file_list(outcome.files),
          {{"steps", outcome.steps}, {"files", names(outcome.files)}}};
}

Output Execution::operator()(RegionsCommand& command) const {
  set_work_at_hand("regions");
  command.request.threads = options.threads;
  RegionsOutcome outcome = mesh_regions(command.request, progress);
  if (!command.formats.empty()) {
    set_work_at_hand("export");
    for (auto& file : export_regions(command.request.folder, command.formats, progress))
      outcome.files.push_back(std::move(file));
  }
  progress.clear();
  return {outcome.code,
          outcome.text + file_list(outcome.files),
          {{"regions", outcome.document}, {"files", names(outcome.files)}}};
}

Output Execution::operator()(BatchCommand& command) const {
  command.request.timeout = options.timeout;
  command.request.threads = std::max(1, options.threads / command.request.jobs);
  const BatchOutcome outcome =
      command.request.collect ? collect_batch(command.request, progress) : run_batch(command.request, progress);
  progress.clear();
  return {outcome.code,
          outcome.text + file_list(outcome.files),
          {{"scans", outcome.rows}, {"files", names(outcome.files)}}};
}

/// Makes the mesh of a case again, with its own parameters, so that each process has its local mesh. Returns null
/// if a single process makes the mesh.
std::shared_ptr<const MeshWithBoundary> Execution::parts_of(const ExportCommand& command) const {
  RunRequest request;
  request.case_folder = command.case_folder;
  const CasePaths paths{command.case_folder};
  if (!std::filesystem::exists(paths.parameters())) return nullptr;
  request.parameters.load(paths.parameters(), ParamSource::Case);
  if (for_one_process(request.parameters)) return nullptr;
  request.from = Stage::Mesh;
  request.report = std::filesystem::exists(paths.report());
  request.threads = options.threads;
  request.ranks = ranks.mesher;
  request.keeps_parts = request.needs_parts = true;
  return run_case(request, progress).parts;
}

constexpr const char* kKeysOfPatches[] = {keys::output::label_names, keys::output::label_min_area,
                                          keys::output::patch_angle, keys::output::patch_planar};

/// \throw UsageError  a parameter that divides the boundary into patches
void require_no_patches(const Parameters& parameters) {
  for (const char* key : kKeysOfPatches) {
    if (parameters.source(key) >= ParamSource::Set)
      throw UsageError(std::string(key) + " applies to one body; the patches of several are their interfaces");
  }
}

/// Reports settings of former calls that divide the boundary into patches.
void tell_patches(const ExportCommand& command, Progress& progress) {
  const auto concerns = [](const std::string& text) {
    return std::any_of(std::begin(kKeysOfPatches), std::end(kKeysOfPatches),
                       [&](const char* key) { return text.starts_with(key); });
  };
  for (const KeptParameter& kept : command.parameters.kept()) {
    if (concerns(kept.key)) progress.say("export: keeps " + kept.words + " (--fresh drops it)");
  }
  for (const std::string& change : command.changed) {
    if (concerns(change)) progress.say("export: " + change);
  }
}

Output Execution::operator()(const ExportCommand& command) const {
  require_case(command.case_folder);
  require_formats(command.formats);
  if (has_regions(command.case_folder)) {
    require_no_patches(command.parameters);
    set_work_at_hand("export");
    const CaseLock lock(command.case_folder);
    const auto files = export_regions(command.case_folder, command.formats, progress);
    progress.clear();
    return output_of_files(files);
  }
  tell_patches(command, progress);
  if (ranks.n == 1 || !is_in_pieces(command.formats)) require_current_mesh({command.case_folder});
  std::shared_ptr<const MeshWithBoundary> parts;
  if (ranks.n > 1 && is_in_pieces(command.formats)) parts = parts_of(command);
  const auto files = exports_of({command.case_folder}, command.formats, command.parameters, progress, parts.get());
  progress.clear();
  return output_of_files(files);
}

Output Execution::operator()(const ReportCommand& command) const {
  set_work_at_hand("report");
  require_case(command.case_folder);
  const CasePaths paths{command.case_folder};
  const CaseLock lock(paths.root);
  require_current_mesh(paths);
  progress.report("report", "write", .5);
  report_case(paths);
  progress.clear();
  return output_of_files({paths.report()});
}

Output Execution::operator()(const ViewCommand& command) const {
  set_work_at_hand("view");
  require_case(command.case_folder);
  const CasePaths paths{command.case_folder};
  const CaseLock lock(paths.root);
  require_current_mesh(paths);
  const std::vector<std::filesystem::path> files = write_view(paths, progress);
  progress.clear();
  return output_of_files(files);
}

Output Execution::operator()(const DiffCommand& command) const {
  set_work_at_hand("diff");
  const CasePaths a{command.case_a}, b{command.case_b};
  const CaseDiff found = diff_cases(a, b, progress);
  const std::filesystem::path page = command.page.empty() ? b.root / "diff.html" : command.page;
  const bool is_drawn = write_diff_page(page, a, b, found);
  progress.clear();
  const std::string text = diff_text(found, options.verbosity == Verbosity::Verbose);
  return {ExitCode::Success,
          is_drawn ? text + "picture: " + page.string() + "\n" : text,
          {{"diff", to_json(found)}, {"picture", is_drawn ? Json(page.string()) : Json(nullptr)}}};
}

/// Applies the limits of memory and time to this process. The limits of a batch apply to its scans, which run in
/// their own processes.
void keep_limits(const Command& command, const CommonOptions& options) {
  if (std::holds_alternative<BatchCommand>(command)) return;
  const OutputParameters limits = std::visit(
      [](const auto& c) {
        if constexpr (requires { c.parameters; }) return c.parameters.output();
        if constexpr (requires { c.request; }) return c.request.parameters.output();
        return OutputParameters{};
      },
      command);
  if (limits.max_memory > 0) limit_memory(1e9 * limits.max_memory, options.threads);
  if (options.timeout > 0) stop_after(options.timeout);
}

/// Checks a call with several processes. \throw UsageError if the command runs in a single process
void require_ranks(const Command& command) {
  const auto* run = std::get_if<RunCommand>(&command);
  const auto* evolve = std::get_if<EvolveCommand>(&command);
  if (std::holds_alternative<ExportCommand>(command)) return;
  if (!run && !evolve) throw UsageError("this command runs in a single process; start it without mpirun");
  if (run && run->request.until < Stage::Mesh) return;
  const auto reason = for_one_process(run ? run->request.parameters : evolve->request.parameters);
  if (reason)
    throw UsageError(*reason + " requires a single process; several processes can only mesh a lattice without walls");
}

/// @param json  set as soon as the call is parsed; decides the form of a failure
Output execute(int argc, char** argv, const RanksOfProgram& ranks, bool& json, std::string& name) {
  CommandLine call = parse_command_line(argc, argv);
  CommonOptions& options = call.options;
  Progress progress(options.progress, options.verbosity);
  const Execution execution{options, progress, ranks};
  if (const auto* answer = std::get_if<TextAnswer>(&call.command)) return execution(*answer);
  json = options.json;
  name = call.name;
  if (json) answer_stops_in_json(name.c_str());
  if (ranks.n > 1) require_ranks(call.command);
  const int all = tbb::info::default_concurrency();
  if (ranks.mesher) ranks.mesher->set_threads(options.threads > 0 ? options.threads : std::max(1, all / ranks.n_here));
  if (options.threads == 0) options.threads = all;
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(options.threads));
  keep_limits(call.command, options);
  return std::visit(execution, call.command);
}

/// Writes to stderr. If that fails, only the exit code reports the error. (fmt::print would throw.)
template <class... T>
void complain(fmt::format_string<T...> format, T&&... args) {
  const std::string text = fmt::format(format, std::forward<T>(args)...);
  std::fwrite(text.data(), 1, text.size(), stderr);
}

bool print(const std::string& text) {
  return std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
}

}  // namespace

int run_program(int argc, char** argv, const RanksOfProgram& ranks) {
  // A call that cannot be parsed still gets a document if it contains --json.
  bool json = std::any_of(argv, argv + argc, [](const char* a) { return std::string_view(a) == "--json"; });
  if (json) answer_stops_in_json("");
  std::string command;
  Output output;
  std::optional<Failure> failure;
  try {
    output = execute(argc, argv, ranks, json, command);
  } catch (...) {
    failure = failure_of(std::current_exception());
  }
  if (failure) {
    output.code = failure->code;
    output.text.clear();
    output.document = {{"error", failure->message}};
    output.document.update(failure->evidence);
  }
  if (json) {
    Json document = {{"schema", 1}, {"command", command}, {"exit_code", static_cast<int>(output.code)}};
    if (output.document.is_object()) document.update(output.document);  // --version and --help have no document
    output.text = document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  }
  take_last_word();
  if (failure) complain("umtet: {}\n", failure->message);
  if (!print(output.text)) {
    complain("umtet: cannot write to stdout\n");
    if (output.code == ExitCode::Success) output.code = ExitCode::FileTrouble;
  }
  say_no_more();
  return static_cast<int>(output.code);
}

void keep_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  mallopt(M_TOP_PAD, 16 << 20);
#endif
}

}  // namespace umtet
