#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/case/record.h"

namespace umtet {

/// What became of one scan of a batch.
struct BatchRow {
  std::string scan;     ///< its path, absolute
  std::string name;     ///< of its case, a folder in that of the batch
  std::string verdict;  ///< pass, or what verdict_of() says
  int exit_code = -1;   ///< of `umtet run`; -1: not run yet, or ended by a signal
  std::string reason;   ///< empty when the verdict is pass
  double seconds = 0;
  double peak_memory_MB = 0;
  std::optional<std::int64_t> n_tets;
  std::optional<double> min_quality;
  std::string key;  ///< checksum of scan, parameters and version; empty where the scan cannot be read
};

inline constexpr const char* kWaiting = "waiting";  ///< verdict of a scan that has not been run yet

/// The word for an exit code of `umtet run`; "crash" for what is none of the contract.
std::string verdict_of(int exit_code);

/// batch.csv, batch.html and batch.json of `folder`, replaced together. The last one is what read_batch() reads.
/// \throw std::system_error
void write_batch(const std::filesystem::path& folder, const std::vector<BatchRow>& rows);

/// The rows of an earlier run; none where there is no batch.json, or it is damaged or of another version.
std::vector<BatchRow> read_batch(const std::filesystem::path& folder);

/// The rows as batch.json has them.
Json batch_rows(const std::vector<BatchRow>& rows);

/// Names of the files of write_batch().
std::vector<std::filesystem::path> batch_files(const std::filesystem::path& folder);

}  // namespace umtet
