#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/vec3.h"
#include "pipeline/case/artefact.h"
#include "pipeline/case/case_folder.h"
#include "pipeline/case/json_values.h"

namespace umtet {

/// A file that a stage read or wrote, as stored in the record of the stage.
struct RecordedFile {
  std::string name;  ///< outputs: in the folder of the stage; inputs: in the case, or "source" for the user's cloud
  FileStamp stamp;
  bool operator==(const RecordedFile&) const = default;
};

/// Data of one run of a stage; they differ from run to run.
struct StageRun {
  double seconds = 0;
  double peak_memory_MB = 0;  ///< peak memory of the process until the end of the stage
  int threads = 0;
  std::string host;
  std::string date;    ///< UTC, as in 2026-01-31T12:00:00Z
  std::string source;  ///< for 1-cloud: absolute path of the user's file; otherwise empty
};

/// The contents of record.json: what a finished stage did. The record is written last, so a stage with a valid
/// record is done.
struct StageRecord {
  Stage stage = Stage::Cloud;
  Json parameters;  ///< parameters of the section of the stage
  std::vector<RecordedFile> inputs, outputs;
  Json numbers;  ///< to_json() of its report (stage_reports.h); like all fields above, equal bytes for equal input,
                 ///< parameters and version
  StageRun run;
};

/// Returns the document with the checksum of its contents, stored in the block `run`, which differs from run to run
/// anyway.
Json sealed(Json document);
/// Returns the checksum that sealed() stores.
std::string seal_of(const Json& document);
/// Returns false if the document was changed after sealed().
bool seal_holds(const Json& document);
/// Returns the text of a document as files of a case contain it. Bytes that are not UTF-8 (in the name of a file)
/// are replaced.
std::string file_text(const Json& document);

/// Stamps the outputs, which must be complete and in the folder of the stage, and writes the record atomically.
/// \throw std::system_error
void write_record(const CasePaths& paths, StageRecord record, const std::vector<std::string>& output_names);

/// The state of a stage, according to its record and the files that the record names.
struct StageState {
  enum class Kind {
    Done,     ///< everything matches
    Missing,  ///< never finished
    Changed,  ///< finished and complete, but with other parameters, another version or other input
    Damaged,  ///< an output or the record is missing or differs from what was written
  };
  Kind kind = Kind::Missing;
  std::string reason;                 ///< a clause for the user; empty if Done
  std::optional<StageRecord> record;  ///< for Done and Changed
};

/// Inspects a stage. Reads every output whose stamp is not known yet.
/// @param inputs  files that the stage would read now; nullopt: assume that the recorded inputs are current
StageState inspect_stage(const CasePaths& paths, Stage stage, const Json& parameters,
                         const std::optional<std::vector<RecordedFile>>& inputs);

/// Returns a clause for each parameter of a section that differs, such as "mesh.h was 0.0, is 0.02"; empty if all
/// are equal.
std::vector<std::string> differences(const std::string& section, const Json& before, const Json& now);

/// Reads the record without checking its outputs.
/// \throw ArtefactDamaged, std::system_error  names the file
StageRecord read_record(const CasePaths& paths, Stage stage);

/// Returns the data of the run of a stage that ends now.
StageRun run_of_stage(double seconds, int threads);

}  // namespace umtet
