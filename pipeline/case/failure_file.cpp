#include "pipeline/case/failure_file.h"

#include <algorithm>

#include "pipeline/case/artefact.h"
#include "pipeline/case/json_values.h"
#include "pipeline/case/record.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

fs::path failure_file(const CasePaths& paths) { return paths.root / "failure.json"; }

}  // namespace

void write_failure(const CasePaths& paths, const CaseFailure& failure) {
  if (fs::exists(CasePaths{paths.root}.certificate())) return;
  const bool has_stage = std::any_of(kStages.begin(), kStages.end(), [&](Stage stage) {
    return fs::exists(paths.record(stage)) || fs::exists(CasePaths{paths.root}.record(stage));
  });
  if (!has_stage && !fs::exists(paths.failed())) return;
  const Json document = {
      {"stage", to_string(failure.stage)}, {"exit_code", static_cast<int>(failure.code)}, {"message", failure.message}};
  write_text_artefact(failure_file(paths), file_text(document));
}

std::optional<CaseFailure> read_failure(const CasePaths& paths) {
  if (!fs::exists(failure_file(paths))) return std::nullopt;
  const Json document = Json::parse(read_text(failure_file(paths)), nullptr, false);
  try {
    return CaseFailure{parse_stage(document.at("stage")), static_cast<ExitCode>(document.at("exit_code").get<int>()),
                       document.at("message")};
  } catch (const Json::exception&) {
  } catch (const UsageError&) {
  }
  return std::nullopt;
}

void remove_failure(const CasePaths& paths) { fs::remove(failure_file(paths)); }

}  // namespace umtet
