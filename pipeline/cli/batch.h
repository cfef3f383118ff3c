#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/case/exit_code.h"
#include "pipeline/case/parameters.h"
#include "pipeline/case/progress.h"
#include "pipeline/case/record.h"

namespace umtet {

/// Many scans by the same parameters, on this machine.
struct BatchRequest {
  std::filesystem::path list;  ///< of listed_clouds()
  std::filesystem::path folder;
  Parameters parameters;
  std::vector<std::string> formats;  ///< exported from every mesh
  int jobs = 1;                      ///< scans at a time
  int threads = 1;                   ///< of every scan
  double timeout = 0;                ///< seconds for a scan; 0: any
  bool resume = false;               ///< scans that failed by themselves are not tried again
  bool force = false;                ///< of `umtet run`
  bool collect = false;              ///< nothing is run, see collect_batch()
};

struct BatchOutcome {
  Json rows = Json::array();  ///< by scan: what batch.json has
  std::vector<std::filesystem::path> files;
  std::string text;                   ///< for people
  ExitCode code = ExitCode::Success;  ///< GateFailed when a scan does not pass
};

/// Runs `umtet run SCAN -o FOLDER/NAME` for every scan, in processes of their own: whatever becomes of one, a crash
/// included, is a row, and the others go on. The tables of write_batch() are complete after every scan; what a scan
/// said is in FOLDER/logs. Cases that are whole are not made again. A scan that runs out of time is asked to stop, and
/// killed when it does not.
/// \throw UsageError (also for a folder that is a case, or has a batch.csv that is none of ours), Interrupted when the
///        scans that ran have stopped, std::system_error when a table cannot be written
BatchOutcome run_batch(const BatchRequest& request, Progress& progress);

/// The tables of what other machines have made in the folder: of every scan FOLDER/logs/NAME.json has what
/// `umtet run SCAN -o FOLDER/NAME --json` printed, and FOLDER/logs/NAME.log what it said. A scan without an answer that
/// is whole waits. Seconds and memory are those of the records of the cases. Nothing is run, and no scan is read.
/// \throw as run_batch()
BatchOutcome collect_batch(const BatchRequest& request, Progress& progress);

}  // namespace umtet
