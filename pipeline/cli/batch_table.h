#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/case/record.h"

namespace umtet {

/// The result of one scan of a batch.
struct BatchRow {
  std::string scan;     ///< absolute path
  std::string name;     ///< name of its case, a subfolder of the batch folder
  std::string verdict;  ///< a word of verdict_of(), or kWaiting
  int exit_code = -1;   ///< exit code of `umtet run`; -1: not run yet, or ended by a signal
  std::string reason;   ///< empty if the verdict is "pass"
  double seconds = 0;
  double peak_memory_MB = 0;
  std::optional<std::int64_t> n_tets;
  std::optional<double> min_quality;
  std::string key;  ///< checksum of scan, parameters and version; empty if the scan cannot be read
};

inline constexpr const char* kWaiting = "waiting";  ///< verdict of a scan that has not been run yet

/// Returns the word for an exit code of `umtet run`; "crash" for an undocumented code.
std::string verdict_of(int exit_code);

/// Replaces batch.csv, batch.html and batch.json in `folder` together. read_batch() reads batch.json.
/// \throw std::system_error
void write_batch(const std::filesystem::path& folder, const std::vector<BatchRow>& rows);

/// Returns the rows of an earlier run; none if batch.json is missing, damaged or from another version.
std::vector<BatchRow> read_batch(const std::filesystem::path& folder);

/// Returns the rows in the form of batch.json.
Json batch_rows(const std::vector<BatchRow>& rows);

/// Returns the paths of the files that write_batch() writes.
std::vector<std::filesystem::path> batch_files(const std::filesystem::path& folder);

}  // namespace umtet
