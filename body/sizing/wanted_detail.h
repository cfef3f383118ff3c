#pragma once

#include <optional>

#include "body/options.h"

namespace umtet {

/// Returns the edge of the largest cells in which samples may be merged: half the spacing of the finest lattice that
/// the mesh uses, or .35 h; within such a cell, the fit also takes the mean of the samples. If the library chooses h,
/// the result is for half of the h of a body without thin parts, because folded faces may require this. With mesh.tets
/// it is for a body that fills a twentieth of the cube of its diagonal, because the volume is not yet known.
/// @return 0 if samples must not be merged: with mesh.max_deviation, sizes, a background that is neither a tiling nor
///         chosen by the library, reconstruct.weights = paper, or cloud.merge = false
/// @param diagonal  diagonal of the cloud, model units
double largest_cell(const BodyOptions& options, double diagonal);

/// Returns the edge of cells for a body with thin parts: if the library chooses h, it is the edge for h = thickness /
/// 2.2.
/// @param largest    result of largest_cell()
/// @param thickness  1 % quantile of the thickness at the samples, model units
double cell_where_thin(const BodyOptions& options, double largest, double thickness);

/// Estimates of the body from merged samples.
struct ScanSize {
  double diagonal = 0, volume = 0, area = 0;  ///< model units, their squares and cubes
  double noise = 0;                           ///< standard deviation along the normal, model units
  std::optional<double> thickness = {};       ///< 1 % quantile of the thickness at the samples
};

/// Returns 1.05 times the spacing of the finest lattice that the mesh will use. It depends on an estimate of h: mesh.h,
/// the h for mesh.tets, or the choice of choose_edge_length() for a body without thin parts.
/// @return 0 if it is not known, for example because parts thinner than 2.2 h determine h
double finest_lattice(const BodyOptions& options, const ScanSize& scan);

}  // namespace umtet
