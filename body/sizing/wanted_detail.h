#pragma once

#include <optional>

#include "body/options.h"

namespace umtet {

/// The edge of the largest cells in which samples may be merged: half the spacing of the finest lattice that the mesh
/// uses, .35 h, where the fit itself takes the mean of samples. Where h is left to us it may become half of what it is
/// for a body without thin parts, as faces that fold ask for. With mesh.tets it is that of a body which fills a
/// twentieth of the cube of its diagonal, since the volume is not known yet. @return 0 where samples are not to be
/// merged: mesh.max_deviation, sizes, another background than a tiling or
///         ours, reconstruct.weights = paper, cloud.merge = false
/// @param diagonal  of the cloud, model units
double largest_cell(const BodyOptions& options, double diagonal);

/// The edge of cells for a body with thin parts: that of the h that these lead to, a 2.2th of their thickness, if h is
/// left to us.
/// @param largest    largest_cell()
/// @param thickness  that 1 % of the samples fall below, model units
double cell_where_thin(const BodyOptions& options, double largest, double thickness);

/// What merged samples say of the body.
struct ScanSize {
  double diagonal = 0, volume = 0, area = 0;  ///< model units, their squares and cubes
  double noise = 0;                           ///< standard deviation along the normal, model units
  std::optional<double> thickness = {};       ///< that 1 % of the samples fall below
};

/// The spacing of the finest lattice that the mesh will use, and a twentieth more, for an h that is estimated: for
/// mesh.h, for the h of mesh.tets, or for the one that choose_edge_length() takes for a body without thin parts.
/// @return 0 if that cannot be told, as where parts thinner than 2.2 h decide
double finest_lattice(const BodyOptions& options, const ScanSize& scan);

}  // namespace umtet
