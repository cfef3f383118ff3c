#include "body/sizing/wanted_detail.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "mesh/sizes/body_size.h"
#include "body/sizing/background_choice.h"
#include "body/sizing/edge_length.h"
#include "reconstruct/solve/resolution.h"

namespace umtet {
namespace {

constexpr double kCellOfLattice = .5;  // as SSD samples are merged on every level
// Attempts with smaller h end at .51 of it (mesh_attempts.h).
constexpr double kLeastAttempt = .5;
// Bodies that fill a twentieth of the cube of their diagonal have half of kMeshEdge as their h with so many tets: an
// A15 has 9 tets in h^3.
constexpr double kTetsOfDefault = 1e6;
// An h that is estimated from samples is good to 3 % (edge_length.cpp); --tets moves it by as much.
constexpr double kEstimated = 1.05;

bool is_uniform(const Parameters& p) {
  const MeshParameters& mesh = p.mesh();
  const bool is_tiling = mesh.background != "graded" && !background_file(p);
  return is_tiling && mesh.size.empty() && mesh.size_at.empty() && mesh.max_deviation == 0;
}

/// Half the spacing of the finest lattice that a mesh of edge h uses.
double cell_of(const Parameters& parameters, double h) {
  const ReconstructParameters& fit = parameters.reconstruct();
  const double lattice = fit.spacing > 0 ? std::min(fit.spacing, kLeastSpacing * h) : kLeastSpacing * h;
  return kCellOfLattice * lattice / std::max(1., fit.detail);
}

}  // namespace

Json wanted_mesh(const Parameters& parameters) {
  const MeshParameters& mesh = parameters.mesh();
  return {{"h", mesh.h},
          {"tets", mesh.tets},
          {"max_tets", mesh.max_tets},
          {"max_deviation", mesh.max_deviation},
          {"background", mesh.background},
          {"size", mesh.size},
          {"size_at", mesh.size_at}};
}

double largest_cell(const Parameters& parameters, double diagonal) {
  if (!parameters.cloud().merge || !is_uniform(parameters)) return 0;
  if (parameters.reconstruct().weights == SampleWeights::Paper) return 0;
  const MeshParameters& mesh = parameters.mesh();
  double h = kLeastAttempt * kMeshEdge * diagonal;
  if (mesh.tets > 0) {
    h /= std::cbrt(static_cast<double>(mesh.tets) / kTetsOfDefault);
  } else if (mesh.h > 0) {
    h = mesh.h;
  }
  return cell_of(parameters, h);
}

double cell_where_thin(const Parameters& parameters, double largest, double thickness) {
  if (parameters.mesh().tets > 0 || parameters.mesh().h > 0) return largest;
  return std::min(largest, cell_of(parameters, thickness / kEdgesAcross));
}

double finest_lattice(const Parameters& parameters, const ScanSize& scan) {
  if (!is_uniform(parameters) || !(scan.volume > 0)) return 0;
  const MeshParameters& mesh = parameters.mesh();
  const auto h_of = [&](std::int64_t n) {
    return h_for_tets(tiling_of(parameters), {scan.volume, scan.area}, static_cast<double>(n),
                      classification_source(parameters));
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
