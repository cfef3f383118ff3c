#pragma once

#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/reports/certificate_report.h"
#include "pipeline/run/time_steps.h"

namespace umtet {

/// An instant of `umtet evolve`, and its result.
struct EvolveStep {
  TimeStep at;
  std::string file;   ///< name of the file in the folder
  std::string error;  ///< reason why there is no mesh
  std::exception_ptr thrown;
  std::optional<MeshMeasures> measured;  ///< measurements; set if there is a mesh
  Verdict verdict;                       ///< verdict on the measurements
  double seconds = 0;                    ///< time of mesh and certificate; for a cloud, also of its level set
  bool looked_at = false;                ///< the data that the background needs have been collected

  bool made() const { return measured.has_value(); }
};

inline constexpr const char* kSeries = "series.pvd";

/// Writes quality.csv, quality.svg and series.pvd, with the steps that have been made or have failed so far; each file
/// atomically. \throw std::system_error  names the file
void write_tables(const std::filesystem::path& folder, const std::vector<EvolveStep>& steps);

}  // namespace umtet
