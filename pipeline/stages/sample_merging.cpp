#include "pipeline/stages/sample_merging.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "pipeline/domain/wanted_detail.h"
#include "reconstruct/cloud/cloud_survey.h"
#include "reconstruct/cloud/merged_samples.h"
#include "reconstruct/cloud/neighbour_tree.h"

namespace umtet {
namespace {

// Fewer samples a cell are not worth what their mean loses.
constexpr std::size_t kLeastMean = 4;
// This many are prepared and fitted in a second or two: merging gains nothing below.
constexpr std::size_t kFewestCells = 100'000;
// Samples per cell that leave neighbours as near as sheets are that the samples themselves could tell apart: the
// distance between samples becomes less than three times what it was.
constexpr std::size_t kCautiousMean = 8;
// psi fitted to cells is right for parts of 2.2 edges (kEdgesAcross) of 1.4 cells (kLeastSpacing).
constexpr double kThinnestInCells = 3.5;
// Share of cells or samples that makes a body thin: that of choose_edge_length().
constexpr double kThinShare = .01;
constexpr std::size_t kRays = 2000;  // 20 of them below that share

bool is_thin(const PreparedCloud& prepared, double cell) {
  const std::vector<double> t = thicknesses(prepared.cloud, NeighbourTree(prepared.cloud.points), kRays);
  return !t.empty() &&
         t[static_cast<std::size_t>(kThinShare * static_cast<double>(t.size() - 1))] < kThinnestInCells * cell;
}

}  // namespace

PreparedCloud prepare_merged(CloudFile file, const std::filesystem::path& source, const Parameters& parameters) {
  const std::size_t n = file.cloud.points.size();
  if (n < kLeastMean * kFewestCells || file.report.of_triangles)
    return prepare_cloud(std::move(file), source, parameters);
  if (parameters.cloud().normals == NormalsOf::Estimate) file.cloud.normals = {};
  const CoreBox core = core_box(file.cloud.points);
  const double largest = largest_cell(parameters, core.diagonal);
  if (!(largest > 0)) return prepare_cloud(std::move(file), source, parameters);
  double former = 0;
  for (const bool cautious : {false, true}) {
    if (!cautious && file.cloud.normals.empty()) continue;
    std::optional<MergedSamples> merged;
    double cell = 0;
    {
      const std::size_t fewest = std::max(kFewestCells, cautious ? n / kCautiousMean : 0);
      const SampleCells cells = cells_for(file.cloud.points, core, largest, fewest);
      cell = cells.edge();
      if (kLeastMean * cells.size() > n || cell == former) break;
      former = cell;
      merged = merged_samples(file.cloud, cells);
      const auto n_cells = static_cast<double>(cells.size());
      if (static_cast<double>(merged->n_two_sided) > kThinShare * n_cells) continue;
    }
    const std::size_t n_merged = merged->cloud.points.size();
    PreparedCloud prepared = prepare_cloud({std::move(merged->cloud), file.report}, source, parameters);
    if (is_thin(prepared, cell)) continue;
    prepared.report.merged = {n, n_merged, cell, wanted_mesh(parameters)};
    prepared.report.notices.insert(
        prepared.report.notices.begin(),
        fmt::format("merged {} points in cells of {:.3g}, which leaves {} samples: the mesh shows nothing finer "
                    "(--set cloud.merge=false keeps all)",
                    n, cell, n_merged));
    return prepared;
  }
  return prepare_cloud(std::move(file), source, parameters);
}

}  // namespace umtet
