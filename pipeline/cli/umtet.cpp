// The program: parses the call, runs it, prints data on stdout and the rest on stderr, and returns the exit code.

#include <fmt/format.h>
#include <malloc.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <algorithm>
#include <cstdio>
#include <limits>
#include <optional>
#include <string_view>

#include "pipeline/case/exit_code.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/case/memory.h"
#include "pipeline/case/stop_document.h"
#include "pipeline/cli/command_line.h"
#include "pipeline/meshing/certificate_json.h"
#include "pipeline/meshing/check.h"
#include "pipeline/output/case_diff.h"
#include "pipeline/output/export_case.h"
#include "pipeline/output/inspect.h"
#include "pipeline/output/report.h"
#include "pipeline/output/view_files.h"
#include "pipeline/run/evolve.h"
#include "pipeline/run/run.h"

namespace umtet {
namespace {

/// What goes to stdout: lines for people, or one document for programs.
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

Json names(const std::vector<std::filesystem::path>& files) {
  Json list = Json::array();
  for (const auto& file : files) list.push_back(file.string());
  return list;
}

std::vector<std::filesystem::path> exports_of(const CommandLine& call, Progress& progress) {
  set_work_at_hand("export");
  const CasePaths paths{call.request.case_folder};
  const CaseLock lock(paths.root);
  return export_case(paths, call.formats, call.request.parameters, progress);
}

Output run_stages(const CommandLine& call, Progress& progress) {
  RunOutcome outcome = run_case(call.request, progress);
  if (!call.formats.empty()) {
    for (auto& file : exports_of(call, progress)) outcome.files.push_back(std::move(file));
  }
  progress.clear();
  if (outcome.stages_run.empty()) {
    progress.say(fmt::format("nothing to do: {} is up to date", call.request.case_folder.string()));
  }
  Json stages = Json::array();
  for (const Stage stage : outcome.stages_run) stages.push_back(to_string(stage));
  Output output;
  output.code = outcome.code;
  output.document = {{"case", call.request.case_folder.string()},
                     {"stages_run", stages},
                     {"files", names(outcome.files)},
                     {"certificate", outcome.certificate ? *outcome.certificate : Json(nullptr)}};
  if (outcome.certificate) output.text = summary(*outcome.certificate);
  output.text += file_list(outcome.files);
  return output;
}

Output check(const CommandLine& call, Progress& progress) {
  set_work_at_hand("check");
  Output output;
  const Json json = check_mesh(call.mesh, call.against, call.request.parameters, progress);
  progress.clear();
  if (json.at("verdict") != "pass") output.code = ExitCode::GateFailed;
  output.document = {{"check", json}};
  output.text = summary(json);
  return output;
}

Output inspect(const CommandLine& call, Progress& progress) {
  set_work_at_hand("inspect");
  Output output;
  const Json json = inspect_cloud(call.cloud, progress);
  progress.clear();
  output.document = {{"inspection", json}};
  output.text = inspection_text(json);
  return output;
}

Output run_evolution(const CommandLine& call, Progress& progress) {
  set_work_at_hand("evolve");
  EvolveRequest request = call.evolve;
  request.parameters = call.request.parameters;
  request.threads = call.threads;
  const EvolveOutcome outcome = evolve(request, progress);
  progress.clear();
  Output output;
  output.code = outcome.code;
  output.document = {{"steps", outcome.steps}, {"files", names(outcome.files)}};
  output.text = outcome.text + file_list(outcome.files);
  return output;
}

Output run_scans(const CommandLine& call, Progress& progress) {
  BatchRequest request = call.batch;
  request.parameters = call.request.parameters;
  request.formats = call.formats;
  request.timeout = call.timeout;
  request.threads = std::max(1, call.threads / request.jobs);
  const BatchOutcome outcome = run_batch(request, progress);
  progress.clear();
  Output output;
  output.code = outcome.code;
  output.document = {{"scans", outcome.rows}, {"files", names(outcome.files)}};
  output.text = outcome.text + file_list(outcome.files);
  return output;
}

Output export_files(const CommandLine& call, Progress& progress) {
  Output output;
  const std::filesystem::path& folder = call.request.case_folder;
  if (!std::filesystem::exists(folder)) throw UsageError(folder.string() + ": there is no such case");
  const std::vector<std::filesystem::path> files = exports_of(call, progress);
  progress.clear();
  output.document = {{"files", names(files)}};
  output.text = file_list(files);
  return output;
}

Output make_report(const CommandLine& call, Progress& progress) {
  set_work_at_hand("report");
  const CasePaths paths{call.request.case_folder};
  if (!std::filesystem::exists(paths.root)) throw UsageError(paths.root.string() + ": there is no such case");
  const CaseLock lock(paths.root);
  progress.report("report", "write", .5);
  report_case(paths);
  progress.clear();
  Output output;
  output.document = {{"files", names({paths.report()})}};
  output.text = file_list({paths.report()});
  return output;
}

Output view(const CommandLine& call, Progress& progress) {
  set_work_at_hand("view");
  const CasePaths paths{call.request.case_folder};
  if (!std::filesystem::exists(paths.root)) throw UsageError(paths.root.string() + ": there is no such case");
  const CaseLock lock(paths.root);
  const std::vector<std::filesystem::path> files = write_view(paths, progress);
  progress.clear();
  Output output;
  output.document = {{"files", names(files)}};
  output.text = file_list(files);
  return output;
}

Output diff(const CommandLine& call, Progress& progress) {
  set_work_at_hand("diff");
  const Json json = diff_cases({call.case_a}, {call.case_b}, progress);
  progress.clear();
  Output output;
  output.document = {{"diff", json}};
  output.text = diff_text(json);
  return output;
}

/// @param json  is set as soon as the call is understood, for the document of a failure
Output execute(int argc, char** argv, bool& json, std::string& command) {
  CommandLine call = parse_command_line(argc, argv);
  if (call.action == CommandLine::Action::Text) return {ExitCode::Success, call.text, {}};
  json = call.json;
  command = call.command;
  if (json) answer_stops_in_json(command.c_str());
  if (call.threads == 0) call.threads = tbb::info::default_concurrency();
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(call.threads));
  call.request.threads = call.threads;
  const double max_memory = 1e9 * call.request.parameters.real("output.max_memory");
  if (max_memory > 0 && call.action != CommandLine::Action::Batch) limit_memory(max_memory, call.threads);
  if (call.timeout > 0 && call.action != CommandLine::Action::Batch) stop_after(call.timeout);
  Progress progress(call.progress, call.verbosity);
  switch (call.action) {
    case CommandLine::Action::Check:
      return check(call, progress);
    case CommandLine::Action::Inspect:
      return inspect(call, progress);
    case CommandLine::Action::Evolve:
      return run_evolution(call, progress);
    case CommandLine::Action::Batch:
      return run_scans(call, progress);
    case CommandLine::Action::Export:
      return export_files(call, progress);
    case CommandLine::Action::Report:
      return make_report(call, progress);
    case CommandLine::Action::View:
      return view(call, progress);
    case CommandLine::Action::Diff:
      return diff(call, progress);
    default:
      return run_stages(call, progress);
  }
}

/// To stderr, if it can be written; where it cannot, the exit code has to do. (fmt::print would throw.)
template <class... T>
void complain(fmt::format_string<T...> format, T&&... args) {
  const std::string text = fmt::format(format, std::forward<T>(args)...);
  std::fwrite(text.data(), 1, text.size(), stderr);
}

bool print(const std::string& text) {
  return std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
}

int run_program(int argc, char** argv) {
  // A call that cannot be understood still answers in the language it asked for.
  bool json = std::any_of(argv, argv + argc, [](const char* a) { return std::string_view(a) == "--json"; });
  if (json) answer_stops_in_json("");
  std::string command;
  Output output;
  std::optional<Failure> failure;
  try {
    output = execute(argc, argv, json, command);
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
    if (output.document.is_object()) document.update(output.document);  // --version and --help have none
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

/// Arrays of some megabytes come and go in every stage. What is freed is kept: given back, each page would be asked for
/// again, a twentieth of the time of half a million samples.
void keep_freed_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_MAX, 0);
  mallopt(M_TRIM_THRESHOLD, std::numeric_limits<int>::max());
  mallopt(M_TOP_PAD, 16 << 20);
#endif
}

}  // namespace
}  // namespace umtet

int main(int argc, char** argv) {
  umtet::keep_freed_memory();
  umtet::install_signal_handlers();
  return umtet::run_program(argc, argv);
}
