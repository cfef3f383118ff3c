#include "pipeline/stages/stale_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "pipeline/case/exit_code.h"
#include "pipeline/case/parameters.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

/// Returns the stage in whose folder a file of the case is; none for a file of the user.
std::optional<Stage> stage_of(const CasePaths& paths, const std::string& name) {
  for (const Stage stage : kStages) {
    if (name.starts_with(paths.folder(stage).filename().string() + "/")) return stage;
  }
  return std::nullopt;
}

/// Returns the current stamp of a file in the record of its stage; none if the stage has been removed.
std::optional<FileStamp> stamp_in_case(const CasePaths& paths, Stage stage, const std::string& name) {
  if (!fs::exists(paths.record(stage))) return std::nullopt;
  for (const RecordedFile& f : read_record(paths, stage).outputs) {
    if (name.ends_with("/" + f.name)) return f.stamp;
  }
  return FileStamp{};  // the stage no longer makes this file
}

std::string changed_input(const CasePaths& paths, const StageRecord& mesh) {
  for (const RecordedFile& input : mesh.inputs) {
    const std::optional<Stage> stage = stage_of(paths, input.name);
    if (!stage) {
      if (fs::is_regular_file(input.name) && paths.stamps->of(input.name) != input.stamp)
        return input.name + " has changed since";
      continue;
    }
    const std::optional<FileStamp> now = stamp_in_case(paths, *stage, input.name);
    if (now && *now != input.stamp) return fmt::format("the stage {} has been made again since", to_string(*stage));
  }
  return "";
}

/// Compares parameters that both versions know: another version may have more.
std::string changed_parameters(const CasePaths& paths, const StageRecord& mesh) {
  if (!fs::exists(paths.parameters())) return "";
  Parameters parameters;
  parameters.load(paths.parameters(), ParamSource::Case);
  const Json now = parameters.section(section_of(Stage::Mesh));
  Json known = Json::object(), before = Json::object();
  for (const auto& [key, value] : now.items()) {
    if (!mesh.parameters.contains(key)) continue;
    known[key] = value;
    before[key] = mesh.parameters[key];
  }
  return fmt::format("{}", fmt::join(differences(section_of(Stage::Mesh), before, known), "; "));
}

}  // namespace

std::string stale_reason(const CasePaths& paths, const StageRecord& mesh) {
  const std::string reason = changed_input(paths, mesh);
  return reason.empty() ? changed_parameters(paths, mesh) : reason;
}

void require_current_mesh(const CasePaths& paths) {
  if (!fs::exists(paths.record(Stage::Mesh))) return;
  const std::string reason = stale_reason(paths, read_record(paths, Stage::Mesh));
  if (reason.empty()) return;
  const std::string root = paths.root.string();
  throw UsageError(
      fmt::format("{}: the mesh does not match the current contents of the case ({}); `umtet run {}` makes it again",
                  root, reason, root));
}

}  // namespace umtet
