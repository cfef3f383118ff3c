#include "pipeline/case/record.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <ctime>

#include "pipeline/case/exit_code.h"
#include "pipeline/case/json_fields.h"
#include "pipeline/case/version.h"

namespace umtet {
namespace fs = std::filesystem;
void list_fields(JsonFields& json, RecordedFile& f) {
  json("file", f.name)("size", f.stamp.size)("xxh3", f.stamp.xxh3);
}

void list_fields(JsonFields& json, StageRun& run) {
  json("seconds", run.seconds)("peak_memory_MB", run.peak_memory_MB)("threads", run.threads);
  json("host", run.host)("date", run.date).if_any("source", run.source);
}

/// All fields except the version.
void list_fields(JsonFields& json, StageRecord& r) {
  json.derived("stage", to_string(r.stage))("parameters", r.parameters);
  json("inputs", r.inputs)("outputs", r.outputs)("numbers", r.numbers)("run", r.run);
}

namespace {

// Readers accept this schema only; a stage with a record of another schema is run again.
constexpr int kSchema = 2;

constexpr const char* kSeal = "checksum";

StageRecord record_from(Stage stage, const Json& json) {
  auto record = read_fields<StageRecord>(json);
  record.stage = stage;
  return record;
}

/// Returns a clause about the first output that differs from what was written; empty if there is none.
std::string damage(const fs::path& folder, const std::vector<RecordedFile>& outputs, FileStamps& stamps) {
  for (const RecordedFile& f : outputs) {
    // A name with a slash would let the record of a stage vouch for files elsewhere.
    if (f.name.find('/') != std::string::npos) return "record.json names a file outside its folder";
    const fs::path file = folder / f.name;
    if (!fs::exists(file)) return file.string() + " is missing";
    const FileStamp now = stamps.of(file);
    if (now.size != f.stamp.size) {
      return file.string() + " has " + std::to_string(now.size) + " bytes instead of " + std::to_string(f.stamp.size);
    }
    if (now != f.stamp) return file.string() + " does not match its checksum";
  }
  return "";
}

}  // namespace

std::vector<std::string> differences(const std::string& section, const Json& before, const Json& now) {
  std::vector<std::string> list;
  std::size_t n_known = 0;
  for (const auto& [key, value] : now.items()) {
    n_known += before.contains(key);
    if (!before.contains(key)) {
      list.push_back(fmt::format("{}.{} is new", section, key));
    } else if (before[key] != value) {
      list.push_back(fmt::format("{}.{} was {}, is {}", section, key, before[key].dump(), value.dump()));
    }
  }
  if (n_known < before.size()) list.push_back("other parameters of " + section);
  return list;
}

std::string seal_of(const Json& document) {
  Json open = document;
  open["run"].erase(kSeal);
  return checksum(open.dump(-1, ' ', false, Json::error_handler_t::replace));
}

Json sealed(Json document) {
  std::string seal = seal_of(document);
  document["run"].erase(kSeal);
  document["run"][kSeal] = std::move(seal);
  return document;
}

bool seal_holds(const Json& document) {
  const auto run = document.find("run");
  if (run == document.end() || !run->is_object() || !run->contains(kSeal)) return false;
  return seal_of(document) == (*run)[kSeal];
}

std::string file_text(const Json& document) {
  return document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

void write_record(const CasePaths& paths, StageRecord record, const std::vector<std::string>& output_names) {
  std::vector<fs::path> files;
  files.reserve(output_names.size());
  for (const std::string& name : output_names) files.push_back(paths.folder(record.stage) / name);
  const std::vector<FileStamp> stamps = paths.stamps->of(files);
  for (std::size_t k = 0; k < files.size(); ++k) record.outputs.push_back({output_names[k], stamps[k]});
  Json json = {{"schema", kSchema}, {"tool", "umtet"}, {"version", kVersion}};
  json.update(json_by_fields(std::move(record)));
  write_text_artefact(paths.record(record.stage), file_text(sealed(json)));
}

StageState inspect_stage(const CasePaths& paths, Stage stage, const Json& parameters,
                         const std::optional<std::vector<RecordedFile>>& inputs) {
  using Kind = StageState::Kind;
  const fs::path file = paths.record(stage);
  if (!fs::exists(file)) return {Kind::Missing, file.string() + " does not exist", {}};
  StageRecord record;
  std::string version;
  try {
    const Json json = Json::parse(read_text(file));
    if (json.at("schema") != kSchema || json.at("stage") != to_string(stage)) {
      return {Kind::Missing, file.string() + " has another schema", {}};
    }
    if (!seal_holds(json)) return {Kind::Damaged, file.string() + " does not match its own checksum", {}};
    version = json.at("version");
    record = record_from(stage, json);
  } catch (const Json::exception&) {
    return {Kind::Damaged, file.string() + " cannot be read", {}};
  }
  if (const std::string what = damage(paths.folder(stage), record.outputs, *paths.stamps); !what.empty()) {
    return {Kind::Damaged, what, {}};
  }
  std::string reason =
      fmt::format("{}", fmt::join(differences(section_of(stage), record.parameters, parameters), "; "));
  if (version != kVersion) reason = "made by version " + version;
  if (reason.empty() && inputs && *inputs != record.inputs) reason = "its input has changed";
  const Kind kind = reason.empty() ? Kind::Done : Kind::Changed;
  return {kind, reason, std::move(record)};
}

StageRecord read_record(const CasePaths& paths, Stage stage) {
  const fs::path file = paths.record(stage);
  try {
    return record_from(stage, Json::parse(read_text(file)));
  } catch (const Json::exception&) {
    throw ArtefactDamaged(file.string() + " cannot be read");
  }
}

StageRun run_of_stage(double seconds, int threads) {
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  std::array<char, 32> date{};
  std::strftime(date.data(), date.size(), "%Y-%m-%dT%H:%M:%SZ", &utc);
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const double peak_MB = static_cast<double>(usage.ru_maxrss) / 1024;  // Linux reports KiB
  return {seconds, peak_MB, threads, host.data(), date.data(), {}};
}

}  // namespace umtet
