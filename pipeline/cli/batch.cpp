#include "pipeline/cli/batch.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <map>
#include <memory>
#include <set>
#include <thread>

#include "pipeline/case/case_folder.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/case/version.h"
#include "pipeline/cli/batch_table.h"
#include "pipeline/cli/child_process.h"
#include "pipeline/reports/certificate_json.h"
#include "pipeline/run/time_steps.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

using namespace std::chrono_literals;
constexpr auto kPollPeriod = 10ms;  // short compared with the tenths of a second of the smallest scan
// A child ends 0.1 s after its time limit, unless the system blocks it.
constexpr double kGraceSeconds = 5;

std::string value_text(const Json& value) { return value.is_string() ? value.get<std::string>() : value.dump(); }

/// Returns --set arguments for all parameters that differ from their defaults, except the cloud: each child has its
/// own.
std::vector<std::string> assignments(const Parameters& parameters) {
  const Parameters defaults;
  std::vector<std::string> out;
  for (const char* section : {"cloud", "reconstruct", "mesh", "output"}) {
    const Json now = parameters.section(section), preset = defaults.section(section);
    for (const auto& [name, value] : now.items()) {
      const std::string key = std::string(section) + "." + name;
      if (key == keys::cloud::file || value == preset.at(name)) continue;
      out.insert(out.end(), {"--set", key + "=" + value_text(value)});
    }
  }
  return out;
}

/// Returns a unique case name for each scan, made from its file name. The names of the batch's own files are
/// reserved.
std::vector<std::string> case_names(const std::vector<fs::path>& scans) {
  std::set<std::string> taken = {"logs", "batch.csv", "batch.html", "batch.json"};
  std::vector<std::string> names;
  for (const fs::path& scan : scans) {
    std::string stem = scan.stem().string();
    if (stem.empty() || stem[0] == '.') stem.insert(0, 1, '_');
    std::string name = stem;
    for (int k = 2; !taken.insert(name).second; ++k) name = fmt::format("{}_{}", stem, k);
    names.push_back(name);
  }
  return names;
}

std::string last_line(const fs::path& log) {
  std::string text = fs::exists(log) ? read_text(log) : "";
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

class Batch {
 public:
  Batch(const BatchRequest& request, Progress& progress)
      : request_(request), progress_(progress), settings_(assignments(request.parameters)) {}
  BatchOutcome operator()();
  BatchOutcome collect();

 private:
  struct Running {
    std::size_t row;
    std::unique_ptr<ChildProcess> process;
    bool killed = false;
  };

  void require_own_folder() const;
  void name_rows();
  void collect_row(BatchRow& row) const;
  void list_scans();
  bool is_settled(const BatchRow& former) const;
  void start(std::size_t row);
  bool reap();
  void finish(const Running& child, const ChildEnd& end);
  void read_answer(BatchRow& row, const Json& answer) const;
  void stop_children();
  void work();
  BatchOutcome outcome() const;
  fs::path log(const BatchRow& row, const char* suffix) const { return request_.folder / "logs" / (row.name + suffix); }

  const BatchRequest& request_;
  Progress& progress_;
  const std::vector<std::string> settings_;
  std::vector<fs::path> scans_;
  std::vector<BatchRow> rows_;
  std::map<std::string, BatchRow> former_;  ///< former rows by case name
  std::vector<std::size_t> waiting_;        ///< indices of rows; the next scan is the last element
  std::vector<Running> running_;
  std::size_t n_done_ = 0;
};

/// Returns whether the failure would only repeat with the same parameters.
bool Batch::is_settled(const BatchRow& former) const {
  const auto code = static_cast<ExitCode>(former.exit_code);
  return code == ExitCode::InputRefused || code == ExitCode::ReconstructionFailed ||
         code == ExitCode::MeshingImpossible || code == ExitCode::GateFailed;
}

/// Makes a row for each scan of the list. All rows have the verdict "waiting".
void Batch::name_rows() {
  scans_ = listed_clouds(request_.list);
  const std::vector<std::string> names = case_names(scans_);
  for (std::size_t k = 0; k < scans_.size(); ++k) {
    BatchRow row;
    row.scan = scans_[k].string();
    row.name = names[k];
    row.verdict = kWaiting;
    rows_.push_back(std::move(row));
  }
}

void Batch::list_scans() {
  name_rows();
  for (BatchRow& row : read_batch(request_.folder)) former_[row.name] = std::move(row);
  const std::string settings = fmt::format("{} {}", kVersion, fmt::join(settings_, " "));
  for (std::size_t k = 0; k < scans_.size(); ++k) {
    stop_if_interrupted();
    BatchRow& row = rows_[k];
    try {
      row.key = checksum(stamp(scans_[k]).xxh3 + " " + settings);
    } catch (const std::system_error&) {
      // The run of this scan reports what is wrong with the file.
    }
    const auto former = former_.find(row.name);
    const bool same = former != former_.end() && !row.key.empty() && former->second.key == row.key;
    if (!same) former_.erase(row.name);
    if (request_.resume && same && is_settled(former->second)) {
      row = former->second;
      row.scan = scans_[k].string();
      ++n_done_;
    } else {
      waiting_.push_back(k);
    }
  }
  std::reverse(waiting_.begin(), waiting_.end());
}

void Batch::start(std::size_t k) {
  const BatchRow& row = rows_[k];
  ChildCall call{{"run"}, log(row, ".json"), log(row, ".log")};
  call.arguments.insert(call.arguments.end(), settings_.begin(), settings_.end());
  if (!request_.formats.empty()) {
    call.arguments.insert(call.arguments.end(), {"--export", fmt::format("{}", fmt::join(request_.formats, ","))});
  }
  if (request_.timeout > 0)
    call.arguments.insert(call.arguments.end(), {"--timeout", fmt::format("{}", request_.timeout)});
  if (request_.force) call.arguments.emplace_back("--force");
  call.arguments.insert(call.arguments.end(),
                        {"--json", "--progress", "none", "--threads", fmt::format("{}", request_.threads), "-o",
                         (request_.folder / row.name).string(), "--set", "cloud.file=" + scans_[k].string()});
  running_.push_back({k, std::make_unique<ChildProcess>(call)});
}

void Batch::read_answer(BatchRow& row, const Json& answer) const {
  if (answer.contains("error")) row.reason = answer["error"];
  if (!answer.contains("certificate") || !answer["certificate"].is_object()) return;
  const Certificate certificate = certificate_from(answer["certificate"]);
  row.n_tets = static_cast<std::int64_t>(certificate.measured.mesh.n_tets);
  row.min_quality = certificate.measured.mesh.quality.min;
  if (!certificate.verdict.passes()) row.reason = certificate.verdict.reasons.front();
  // If the mesh was already there, the times are those of the run that made it.
  const auto former = former_.find(row.name);
  if (answer.at("stages_run").empty() && former != former_.end() && former->second.exit_code == row.exit_code) {
    row.seconds = former->second.seconds;
    row.peak_memory_MB = former->second.peak_memory_MB;
  }
}

/// \pre the verdict of the row is "waiting"
void Batch::collect_row(BatchRow& row) const {
  try {
    const Json answer = Json::parse(read_text(log(row, ".json")));
    row.exit_code = answer.at("exit_code");
    row.verdict = verdict_of(row.exit_code);
    read_answer(row, answer);
    if (!answer.contains("certificate") || !answer["certificate"].is_object()) return;
    if (const Certificate certificate = certificate_from(answer["certificate"]); certificate.run) {
      for (const auto& [stage, seconds] : certificate.run->seconds) row.seconds += seconds;
      row.peak_memory_MB = certificate.run->peak_memory_MB;
    }
  } catch (const Json::exception&) {
    row.reason = "the answer is incomplete: the scan is still running, or its process was killed";
  } catch (const ArtefactDamaged&) {
    row.reason = "the certificate in the answer is damaged";
  } catch (const std::system_error&) {
    // There is no answer: the scan has not been run.
  }
}

void Batch::finish(const Running& child, const ChildEnd& end) {
  BatchRow& row = rows_[child.row];
  row.seconds = end.seconds;
  row.peak_memory_MB = end.peak_memory_MB;
  if (end.signal == SIGTERM) {  // the child had not installed its handler yet
    row.verdict = verdict_of(static_cast<int>(ExitCode::Terminated));
    row.reason = "terminated";
  } else if (end.signal != 0) {
    row.verdict = child.killed ? verdict_of(static_cast<int>(ExitCode::ResourceLimit)) : "crash";
    row.reason = child.killed
                     ? fmt::format("did not stop within {} s after its time limit, and was killed", kGraceSeconds)
                     : fmt::format("ended by signal {} ({}){}", end.signal, ::strsignal(end.signal),
                                   end.signal == SIGKILL ? "; the system kills processes when memory runs out" : "");
  } else {
    row.exit_code = end.exit_code;
    row.verdict = verdict_of(end.exit_code);
    try {
      read_answer(row, Json::parse(read_text(log(row, ".json"))));
    } catch (const Json::exception&) {
      // The answer is incomplete, or the process ended before writing it; the last line of the log says why.
    } catch (const ArtefactDamaged&) {
      // The certificate in the answer is incomplete, for the same reasons.
    } catch (const std::system_error&) {
      // There is no answer.
    }
    if (row.reason.empty() && row.verdict != "pass") row.reason = last_line(log(row, ".log"));
    if (row.reason.empty() && row.verdict != "pass") row.reason = fmt::format("exit code {}", end.exit_code);
  }
  ++n_done_;
  progress_.say(fmt::format("[{}/{}] {}: {}{}{}", n_done_, rows_.size(), row.name, row.verdict,
                            row.reason.empty() ? "" : ": ", row.reason));
}

/// Returns whether a child has ended.
bool Batch::reap() {
  bool any = false;
  for (std::size_t k = 0; k < running_.size();) {
    Running& child = running_[k];
    if (const std::optional<ChildEnd> end = child.process->poll()) {
      finish(child, *end);
      running_.erase(running_.begin() + static_cast<std::ptrdiff_t>(k));
      any = true;
      continue;
    }
    if (request_.timeout > 0 && !child.killed && child.process->seconds() > request_.timeout + kGraceSeconds) {
      child.killed = true;
      child.process->send(SIGKILL);
    }
    ++k;
  }
  return any;
}

/// Stops all children. Afterwards their cases are consistent and unlocked.
void Batch::stop_children() {
  for (const Running& child : running_) child.process->send(SIGTERM);
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(kGraceSeconds);
  while (!running_.empty() && std::chrono::steady_clock::now() < end) {
    reap();
    std::this_thread::sleep_for(kPollPeriod);
  }
}

void Batch::work() {
  write_batch(request_.folder, rows_);
  while (!running_.empty() || !waiting_.empty()) {
    while (!waiting_.empty() && running_.size() < static_cast<std::size_t>(request_.jobs)) {
      start(waiting_.back());
      waiting_.pop_back();
    }
    if (interrupt_signal() != 0) {
      stop_children();
      write_batch(request_.folder, rows_);
      stop_if_interrupted();
    }
    if (reap()) {
      write_batch(request_.folder, rows_);
    } else {
      std::this_thread::sleep_for(kPollPeriod);
    }
    progress_.report("batch", "scans", static_cast<double>(n_done_) / static_cast<double>(rows_.size()));
  }
}

BatchOutcome Batch::outcome() const {
  BatchOutcome result;
  std::size_t n_pass = 0;
  std::string others;
  for (const BatchRow& row : rows_) {
    if (row.verdict == "pass") {
      ++n_pass;
    } else {
      others += fmt::format("{:<9} {}: {}\n", row.verdict, row.scan, row.reason);
    }
  }
  result.text = others + fmt::format("{} of {} scans pass\n", n_pass, rows_.size());
  result.rows = batch_rows(rows_);
  result.files = batch_files(request_.folder);
  if (n_pass < rows_.size()) result.code = ExitCode::GateFailed;
  return result;
}

void Batch::require_own_folder() const {
  if (fs::exists(CasePaths{request_.folder}.parameters())) {
    throw UsageError(request_.folder.string() + " is a case: choose another folder for the cases of the batch");
  }
  const std::vector<fs::path> files = batch_files(request_.folder);
  if (fs::exists(files.front()) && !fs::exists(files.back())) {
    throw UsageError(files.front().string() + " exists and was not made by umtet batch: choose another folder");
  }
}

BatchOutcome Batch::collect() {
  if (!fs::is_directory(request_.folder / "logs"))
    throw UsageError(request_.folder.string() + ": logs/ contains no answer of a scan");
  const CaseLock lock(request_.folder);
  require_own_folder();
  set_work_at_hand("batch");
  name_rows();
  for (BatchRow& row : rows_) {
    stop_if_interrupted();
    collect_row(row);
    progress_.report("batch", "collect", static_cast<double>(++n_done_) / static_cast<double>(rows_.size()));
  }
  remove_stale_temporaries(request_.folder);
  write_batch(request_.folder, rows_);
  return outcome();
}

BatchOutcome Batch::operator()() {
  const CaseLock lock(request_.folder);
  require_own_folder();
  stop_in_own_time();  // the scans stop first
  set_work_at_hand("batch");
  list_scans();
  fs::create_directories(request_.folder / "logs");
  remove_stale_temporaries(request_.folder);
  work();
  return outcome();
}

}  // namespace

BatchOutcome run_batch(const BatchRequest& request, Progress& progress) { return Batch(request, progress)(); }

BatchOutcome collect_batch(const BatchRequest& request, Progress& progress) {
  return Batch(request, progress).collect();
}

}  // namespace umtet
