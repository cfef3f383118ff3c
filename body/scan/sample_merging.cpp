#include "body/scan/sample_merging.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "body/option_names.h"
#include "body/sizing/wanted_detail.h"
#include "common/formatted.h"
#include "reconstruct/cloud/cleaning/merged_samples.h"
#include "reconstruct/cloud/neighbours/neighbour_tree.h"
#include "reconstruct/cloud/survey/cloud_survey.h"

namespace umtet {
namespace {

// A second pass over fewer samples a cell takes as long as it saves.
constexpr std::size_t kLeastMean = 2;
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
// In cells: a sample stays if one that is near another sheet is at most in the next cell but one.
constexpr double kAroundThin = 2;

/// What 1 % of the samples are thinner than; infinite where none faces another.
double thin_share(const OrientedPointCloud& cloud) {
  const std::vector<double> t = thicknesses(cloud, NeighbourTree(cloud.points), kRays);
  return t.empty() ? std::numeric_limits<double>::infinity()
                   : t[static_cast<std::size_t>(kThinShare * static_cast<double>(t.size() - 1))];
}

/// The samples merged in cells, but for those near which a part or a gap is thinner than the cells show: these stay.
/// @param prepared  the same samples merged in larger cells
MergedSamples merged_but_where_thin(const OrientedPointCloud& all, const SampleCells& cells,
                                    const OrientedPointCloud& prepared) {
  const std::vector<Vec3> thin =
      near_other_sheets(prepared, NeighbourTree(prepared.points), kThinnestInCells * cells.edge());
  if (thin.empty()) return merged_samples(all, cells);
  const NeighbourTree tree(thin);
  const double radius = kAroundThin * cells.edge();
  return merged_samples(all, cells, [&](const Vec3& x) { return tree.count_within(x, radius * radius, 1) > 0; });
}

}  // namespace

PreparedCloud prepare_merged(CloudFile file, const std::string& name, const BodyOptions& options) {
  const std::size_t n = file.cloud.points.size();
  if (n < kLeastMean * kFewestCells || file.report.of_triangles) return prepare_cloud(std::move(file), name, options);
  if (options.scan.normals == NormalsOf::Estimate) file.cloud.normals = {};
  const CoreBox core = core_box(file.cloud.points);
  const double largest = largest_cell(options, core.diagonal);
  if (!(largest > 0)) return prepare_cloud(std::move(file), name, options);
  const bool has_normals = !file.cloud.normals.empty();
  const auto prepare = [&](MergedSamples merged, double cell) {
    const std::size_t n_merged = merged.cloud.points.size();
    PreparedCloud prepared = prepare_cloud({std::move(merged.cloud), file.report}, name, options);
    prepared.report.merged = {n, n_merged, cell};
    prepared.report.notices.insert(
        prepared.report.notices.begin(),
        Message(formatted("merged %zu points in cells of %.3g, which leaves %zu samples: the mesh shows nothing finer",
                          n, cell, n_merged),
                {{Change::Use, {option::merge, "false"}, "keeps all"}}));
    return prepared;
  };
  double cell = 0;
  MergedSamples merged;
  bool has_two_sheets = false;
  {
    const std::size_t fewest = std::max(kFewestCells, has_normals ? 0 : n / kCautiousMean);
    const SampleCells cells = cells_for(file.cloud.points, core, largest, fewest);
    cell = cells.edge();
    if (kLeastMean * cells.size() <= n) merged = merged_samples(file.cloud, cells);
    has_two_sheets = static_cast<double>(merged.n_two_sided) > kThinShare * static_cast<double>(cells.size());
  }
  if (merged.cloud.points.empty() || (has_two_sheets && !has_normals))
    return prepare_cloud(std::move(file), name, options);
  PreparedCloud prepared = prepare(std::move(merged), cell);
  const double thin = thin_share(prepared.cloud);
  if (thin >= kThinnestInCells * cell && !has_two_sheets) return prepared;
  if (has_normals) {
    cell = cell_where_thin(options, cell, thin);
    merged = merged_but_where_thin(file.cloud, SampleCells(file.cloud.points, cell, core.middle), prepared.cloud);
    if (kLeastMean * merged.cloud.points.size() <= n) return prepare(std::move(merged), cell);
  }
  return prepare_cloud(std::move(file), name, options);
}

}  // namespace umtet
