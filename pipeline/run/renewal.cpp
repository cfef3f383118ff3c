#include "pipeline/run/renewal.h"

#include <algorithm>

#include "pipeline/case/exit_code.h"
#include "pipeline/output/export_case.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

std::vector<std::string> artefacts_in(const fs::path& folder, Stage stage) {
  std::vector<std::string> names;
  std::error_code missing;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, missing)) {
    const std::string name = entry.path().filename().string();
    if (is_artefact(stage, name)) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// Moves the files of a stage into place. Files of a user in the same folder stay.
void move_in(const CasePaths& paths, Stage stage) {
  const CasePaths former{paths.root};
  const fs::path from = paths.folder(stage), to = former.folder(stage);
  fs::create_directories(to);
  fs::remove(former.record(stage));
  const std::vector<std::string> names = artefacts_in(from, stage);
  for (const std::string& name : artefacts_in(to, stage)) {
    if (!std::binary_search(names.begin(), names.end(), name)) fs::remove(to / name);
  }
  for (const std::string& name : names) fs::rename(from / name, to / name);
  fs::rename(paths.record(stage), former.record(stage));
}

/// Removes 4-export. It contains derived data that the user can make again with a known call.
void remove_exports(const CasePaths& paths, Progress& progress) {
  std::string removed;
  for (const fs::path& file : exported_files(paths)) {
    if (fs::remove(file)) removed += (removed.empty() ? "" : ", ") + file.filename().string();
  }
  if (removed.empty()) return;
  progress.say(paths.exports().string() + ": removed " + removed +
               " of the former mesh; umtet export makes them from the new one");
}

bool renews_any(const CasePaths& paths) {
  return std::find(paths.renewed.begin(), paths.renewed.end(), true) != paths.renewed.end();
}

/// Removes superseded stages in CASE/.next. A run that is killed while it moves files leaves CASE/.next without
/// records, or with the record of a stage that has none in its place; this run has made that stage in its place.
void remove_superseded(const CasePaths& paths, const std::vector<Stage>& made) {
  CasePaths next{paths.root};
  next.renewed.fill(true);
  for (const Stage stage : made) fs::remove_all(next.folder(stage));
  if (std::none_of(kStages.begin(), kStages.end(), [&](Stage stage) { return fs::exists(next.record(stage)); })) {
    fs::remove_all(paths.next());
  }
}

bool same_mesh(const CasePaths& paths) {
  const CasePaths former{paths.root};
  return fs::exists(former.mesh()) && paths.stamps->of(former.mesh()) == paths.stamps->of(paths.mesh());
}

}  // namespace

bool holds_results(const CasePaths& paths, Stage stage) {
  if (renews_any(paths)) return true;  // the stages after a stage in .next must not be replaced before it
  const CasePaths former{paths.root};
  return std::any_of(kStages.begin(), kStages.end(),
                     [&](Stage later) { return later >= stage && fs::exists(former.record(later)); });
}

void refuse_foreign_folder(const CasePaths& paths) {
  if (fs::exists(paths.parameters())) return;
  std::vector<fs::path> in_the_way;
  for (const Stage stage : kStages) {
    if (fs::exists(paths.record(stage))) return;  // a case without its case.toml
    for (const std::string& name : artefacts_in(paths.folder(stage), stage)) {
      in_the_way.push_back(paths.folder(stage) / name);
    }
  }
  if (fs::exists(paths.certificate())) in_the_way.push_back(paths.certificate());
  if (in_the_way.empty()) return;
  throw UsageError(in_the_way.front().string() + " already exists, and " + paths.root.string() +
                   " is not a case (it contains no case.toml): choose another folder with -o, or move the file away");
}

void replace_former(const StageContext& context, CasePaths& paths, const std::vector<Stage>& made) {
  if (!renews_any(paths)) return remove_superseded(paths, made);
  fs::remove(paths.certificate());
  fs::remove(paths.report());
  remove_view(paths);
  write_parameters(paths, context.parameters);
  if (paths.renews(Stage::Mesh) && !same_mesh(paths)) remove_exports(paths, context.progress);
  for (const Stage stage : kStages) {
    if (paths.renews(stage)) move_in(paths, stage);
  }
  paths.renewed = {};
  fs::remove_all(paths.next());
}

}  // namespace umtet
