#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/case/exit_code.h"
#include "pipeline/case/parameters.h"
#include "pipeline/case/progress.h"
#include "pipeline/case/record.h"

namespace umtet {

/// Many scans with the same parameters, on this machine.
struct BatchRequest {
  std::filesystem::path list;  ///< text file that listed_clouds() reads
  std::filesystem::path folder;
  Parameters parameters;
  std::vector<std::string> formats;  ///< export formats for every mesh
  int jobs = 1;                      ///< number of scans that run at the same time
  int threads = 1;                   ///< threads per scan
  double timeout = 0;                ///< maximum seconds per scan; 0: no limit
  bool resume = false;               ///< do not repeat scans whose failure would only repeat
  bool force = false;                ///< --force of `umtet run`
  bool collect = false;              ///< run nothing, see collect_batch()
};

struct BatchOutcome {
  Json rows = Json::array();  ///< one element per scan, as in batch.json
  std::vector<std::filesystem::path> files;
  std::string text;                   ///< table in text
  ExitCode code = ExitCode::Success;  ///< GateFailed if a scan does not pass
};

/// Runs `umtet run SCAN -o FOLDER/NAME` for every scan, each in its own process. If one fails or crashes, its row
/// states this, and the others continue. The tables of write_batch() are complete after every scan; FOLDER/logs
/// contains the output of each scan. Finished cases are not made again. A scan that exceeds its time limit receives
/// a signal to stop, and is killed if it does not stop.
/// \throw UsageError (also if the folder is a case, or contains a batch.csv that umtet did not write), Interrupted
///   after the running scans have stopped, std::system_error if a table cannot be written
BatchOutcome run_batch(const BatchRequest& request, Progress& progress);

/// Writes the tables from results that other machines left in the folder. For every scan, FOLDER/logs/NAME.json
/// contains the standard output of `umtet run SCAN -o FOLDER/NAME --json`, and FOLDER/logs/NAME.log its messages. A
/// scan without a complete answer has the verdict "waiting". Seconds and memory come from the records of the cases.
/// Nothing is run, and no scan is read.
/// \throw the exceptions of run_batch()
BatchOutcome collect_batch(const BatchRequest& request, Progress& progress);

}  // namespace umtet
