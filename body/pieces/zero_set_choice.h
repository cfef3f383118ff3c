#pragma once

#include <optional>
#include <string>
#include <vector>

#include "body/body.h"
#include "mesh/implicit/zero_set.h"
#include "mesh/sizes/size_field.h"
#include "reconstruct/level_set/sign_cells.h"

namespace umtet {

/// The pieces of psi = 0, counted on a separate grid or graded mesh, and the choice of the pieces that are meshed.
struct ZeroSetChoice {
  ZeroSetTopology topology;
  double share = 0;               ///< edge lengths of the counting mesh, as a share of the sizes; 0: a grid was used
  std::vector<std::size_t> kept;  ///< indices of the topology.components that are meshed
  /// Sign cells of a level set, edge h / 2 or less, if they were searched: they contain every zero.
  std::optional<SignCells> cells;
  std::vector<Vec3> seeds;           ///< a point of each kept piece
  long euler_characteristic = 0;     ///< Euler characteristic of all kept pieces together
  std::vector<std::string> dropped;  ///< the reason for each other piece
};

/// Returns the points at which the kept pieces of psi = 0 cut the edges of the grid.
std::vector<Vec3> kept_points(const ZeroSetChoice& pieces);

/// Support radius in sample spacings: a patch of surface that is farther from every sample is a guess of the fit.
inline constexpr double kSupportRadius = 3;

/// Returns the support radius of the samples, model units. It is the only definition of this distance.
double support_radius(const Domain& domain);

/// Returns the spacing of the grid on which the pieces are counted for a mesh of edge length h: min(h, lattice
/// spacing), or min(h, half a voxel) for a segmentation. It is larger if the grid would have more than 5e7 nodes.
double counting_spacing(const Domain& domain, double h);

/// Counts the pieces of psi = 0 and chooses those that are meshed. Pieces of a level set without the support of samples
/// are artefacts of the fit.
///
/// Every sample supports the one piece whose cut points are nearest to it, if the distance is at most kSupportRadius
/// sample spacings or, if that is larger, one spacing of the counting grid. So a false sheet around, inside or across
/// the body gets no samples of the body. A piece is kept if at least 10 samples support it, and if its number of
/// samples per area is at least a fiftieth of this number for the piece with the most samples: the sample spacing of a
/// second body may be seven times as large. The piece with the most samples is kept if it has at least one. A formula
/// has no artefacts, so all its pieces are kept.
///
/// @param h      edge length of the mesh; the grid has the spacing counting_spacing(domain, h)
/// @param cells  sign cells of an earlier count of the same psi at a larger h; null: they are searched
/// Cost: one value of psi per node of the grid (for a level set only near sign cells), and one nearest-point query per
/// sample and piece whose box is near it.
/// \throw std::length_error  the box is too elongated for the grid
/// \throw Cancelled
ZeroSetChoice choose_components(const Domain& domain, double h, const Context& context = {},
                                const SignCells* cells = nullptr);

/// Makes the same choice for a mesh of varying sizes: graded_zero_set() counts the pieces.
/// @param finest  the least size
/// @param share   edge lengths of the counting mesh, as a share of the sizes
/// @param cells   their edge is half of (longest edge of the counting mesh) / sqrt(3)
ZeroSetChoice choose_components(const Domain& domain, const SizeField& sizes, double finest, double share,
                                const Context& context = {}, const SignCells* cells = nullptr);

}  // namespace umtet
