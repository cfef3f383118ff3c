#include "pipeline/stages/stages.h"

#include <string>

#include "mesh/io/size_file.h"
#include "pipeline/case/artefact.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/domain/body_options.h"
#include "reconstruct/io/grid_io.h"

namespace umtet {
namespace fs = std::filesystem;

std::vector<RecordedFile> recorded_inputs(const CasePaths& paths, Stage stage, const Parameters& parameters) {
  std::vector<RecordedFile> inputs;
  if (stage == Stage::Mesh) {
    if (const auto file = background_file(parameters)) inputs.push_back({file->string(), paths.stamps->of(*file)});
    if (const std::string& file = parameters.mesh().size; is_size_file(file)) {
      inputs.push_back({file, paths.stamps->of(file)});
    }
    if (const std::string& file = parameters.mesh().level_set; !file.empty()) {
      check_grid_head(file);  // gigabytes that are not a grid are not read for their checksum
      inputs.push_back({file, paths.stamps->of(file)});
    }
  }
  const bool is_alone = stage == Stage::Mesh && has_own_psi(parameters.mesh());
  if (stage == Stage::Cloud || is_alone) return inputs;
  for (const Stage source : {Stage::Cloud, Stage::LevelSet}) {
    if (source >= stage) break;
    const StageState state = inspect_stage(paths, source, parameters.section(section_of(source)), std::nullopt);
    if (!state.record) throw ArtefactDamaged(state.reason);
    for (const RecordedFile& f : state.record->outputs) {
      inputs.push_back({paths.folder(source).filename().string() + "/" + f.name, f.stamp});
    }
  }
  return inputs;
}

void begin_writing(const StageContext& context, Stage stage) {
  const fs::path folder = context.paths.folder(stage);
  fs::create_directories(folder);
  remove_stale_temporaries(folder);
  remove_stale_temporaries(context.paths.root);
  fs::remove(context.paths.record(stage));
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (is_artefact(stage, entry.path().filename().string())) fs::remove(entry.path());
  }
  if (context.paths.renews(stage)) return;
  fs::remove(context.paths.certificate());
  fs::remove(context.paths.report());
  remove_view(context.paths);
  write_parameters(context.paths, context.parameters);
}

void write_parameters(const CasePaths& paths, const Parameters& parameters) {
  const fs::path file = paths.parameters();
  const std::string text = parameters.toml();
  if (!fs::exists(file) || read_text(file) != text) write_text_artefact(file, text);
}

}  // namespace umtet
