#include "body/sizing/wanted_detail.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "body/fitted_level_set.h"
#include "body/sizing/background_choice.h"
#include "body/sizing/edge_length.h"
#include "mesh/sizes/body_size.h"
#include "reconstruct/solve/resolution.h"

namespace umtet {
namespace {

constexpr double kCellOfLattice = .5;  // as SSD samples are merged on every level
// Attempts with smaller h end at .51 of it (mesh_attempts.h).
constexpr double kLeastAttempt = .5;
// Bodies that fill a twentieth of the cube of their diagonal have half of kMeshEdge as their h with so many tets: an
// A15 has 9 tets in h^3.
constexpr double kTetsOfDefault = 1e6;
// An h that is estimated from samples is good to 3 % (edge_length.cpp); MeshOptions::tets moves it by as much.
constexpr double kEstimated = 1.05;

bool is_uniform(const BodyOptions& options) {
  const bool is_tiling = options.mesh.background != "graded" && !has_own_background(options);
  return is_tiling && !options.sizes && !options.label_sizes && options.mesh.max_deviation == 0;
}

/// Half the spacing of the finest lattice that a mesh of edge h uses.
double cell_of(const BodyOptions& options, double h) {
  const FitOptions& fit = options.fit;
  const double lattice = fit.spacing > 0 ? std::min(fit.spacing, kLeastSpacing * h) : kLeastSpacing * h;
  return kCellOfLattice * lattice / std::max(1., fit.detail);
}

}  // namespace

double largest_cell(const BodyOptions& options, double diagonal) {
  if (!options.scan.merge || !is_uniform(options)) return 0;
  if (options.fit.weights == SsdWeights::Paper) return 0;
  const MeshOptions& mesh = options.mesh;
  double h = kLeastAttempt * kMeshEdge * diagonal;
  if (mesh.tets > 0) {
    h /= std::cbrt(static_cast<double>(mesh.tets) / kTetsOfDefault);
  } else if (mesh.h > 0) {
    h = mesh.h;
  }
  return cell_of(options, h);
}

double cell_where_thin(const BodyOptions& options, double largest, double thickness) {
  if (options.mesh.tets > 0 || options.mesh.h > 0) return largest;
  return std::min(largest, cell_of(options, thickness / kEdgesAcross));
}

double finest_lattice(const BodyOptions& options, const ScanSize& scan) {
  if (!is_uniform(options) || !(scan.volume > 0)) return 0;
  const MeshOptions& mesh = options.mesh;
  const auto h_of = [&](std::int64_t n) {
    return h_for_tets(tiling_of(options.mesh), {scan.volume, scan.area}, static_cast<double>(n),
                      classification_source(options));
  };
  double h = mesh.h;
  if (mesh.tets > 0) {
    h = h_of(mesh.tets);
  } else if (!(h > 0)) {
    h = std::max({kMeshEdge * scan.diagonal, h_of(mesh.max_tets), scan.noise / kMostNoise});
  }
  if (scan.thickness && *scan.thickness < kEdgesAcross * h) return 0;
  return kEstimated * kLeastSpacing * h;
}

}  // namespace umtet
