#pragma once

#include <exception>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/reports/certificate_report.h"
#include "pipeline/run/time_steps.h"

namespace umtet {

/// An instant of `umtet evolve`, and what has become of it.
struct EvolveStep {
  TimeStep at;
  std::string file;   ///< its name in the folder
  std::string error;  ///< why there is no mesh
  std::exception_ptr thrown;
  std::optional<MeshMeasures> measured;  ///< while there is a mesh
  Verdict verdict;                       ///< on it
  double seconds = 0;                    ///< mesh and certificate; of a cloud also its level set
  bool looked_at = false;                ///< what the background has to know of it has been taken

  bool made() const { return measured.has_value(); }
};

inline constexpr const char* kSeries = "series.pvd";

/// quality.csv, quality.svg and series.pvd, with the steps that are made or have failed so far; each complete or not at
/// all. \throw std::system_error naming the file
void write_tables(const std::filesystem::path& folder, const std::vector<EvolveStep>& steps);

}  // namespace umtet
