#pragma once

#include <optional>
#include <string>
#include <vector>

#include "common/vec3.h"
#include "pipeline/case/artefact.h"
#include "pipeline/case/case_folder.h"
#include "pipeline/case/json_values.h"

namespace umtet {

/// A file that a stage read or wrote, as its record remembers it.
struct RecordedFile {
  std::string name;  ///< outputs: in the folder of the stage; inputs: in the case, or "source" for the user's cloud
  FileStamp stamp;
  bool operator==(const RecordedFile&) const = default;
};

/// How a stage was run: different every time.
struct StageRun {
  double seconds = 0;
  double peak_memory_MB = 0;  ///< of the process, until the stage ended
  int threads = 0;
  std::string host;
  std::string date;    ///< UTC, as in 2026-01-31T12:00:00Z
  std::string source;  ///< of 1-cloud: the file of the user, with its whole path; else empty
};

/// record.json: what a finished stage did. Written last, so a record that holds means that the stage is done.
struct StageRecord {
  Stage stage = Stage::Cloud;
  Json parameters;  ///< those of its section
  std::vector<RecordedFile> inputs, outputs;
  Json numbers;  ///< to_json() of its report (stage_reports.h); like all of the above, equal bytes for equal input,
                 ///< parameters and version
  StageRun run;
};

/// The document with the checksum of all its content in the block `run`, which is different every time as it is.
Json sealed(Json document);
/// The checksum that sealed() puts in.
std::string seal_of(const Json& document);
/// False when anything in it was changed after sealed().
bool seal_holds(const Json& document);
/// As the files of a case hold it. Bytes that are no UTF-8 (in the name of a file) are replaced.
std::string file_text(const Json& document);

/// Stamps the outputs, which must be in the folder of the stage and whole, and writes the record atomically.
/// \throw std::system_error
void write_record(const CasePaths& paths, StageRecord record, const std::vector<std::string>& output_names);

/// What a record and the files it names say about a stage.
struct StageState {
  enum class Kind {
    Done,     ///< everything matches
    Missing,  ///< never finished
    Changed,  ///< finished and whole, but for other parameters, another version or other input
    Damaged,  ///< an output or the record itself is gone or is not what was written
  };
  Kind kind = Kind::Missing;
  std::string reason;                 ///< a clause for the user, empty when Done
  std::optional<StageRecord> record;  ///< for Done and Changed
};

/// @param inputs  what the stage would read now; nullopt: take the recorded ones for right
/// Cost: reads every output of the stage whose stamp is not known yet.
StageState inspect_stage(const CasePaths& paths, Stage stage, const Json& parameters,
                         const std::optional<std::vector<RecordedFile>>& inputs);

/// How the parameters of a section differ, a clause for each that does, such as "mesh.h was 0.0, is 0.02"; empty if
/// they are the same.
std::vector<std::string> differences(const std::string& section, const Json& before, const Json& now);

/// The record as it stands; whether its outputs are there is not looked at.
/// \throw ArtefactDamaged, std::system_error naming the file
StageRecord read_record(const CasePaths& paths, Stage stage);

/// Of the stage that ends now.
StageRun run_of_stage(double seconds, int threads);

}  // namespace umtet
