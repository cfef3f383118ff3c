#pragma once

#include <optional>
#include <string>
#include <vector>

#include "body/body.h"
#include "mesh/implicit/zero_set.h"
#include "mesh/sizes/size_field.h"
#include "reconstruct/level_set/sign_cells.h"

namespace umtet {

/// The pieces of psi = 0, counted on a grid or a graded mesh of its own, and which of them are meshed.
struct ZeroSetChoice {
  ZeroSetTopology topology;
  double share = 0;                  ///< of the sizes that a graded mesh has; 0: a grid
  std::vector<std::size_t> kept;     ///< which of topology.components are meshed
  std::optional<SignCells> cells;    ///< of a level set, edge h / 2 or less, if searched: they hold every zero
  std::vector<Vec3> seeds;           ///< one point of each piece that is kept
  long euler_characteristic = 0;     ///< of the kept pieces together
  std::vector<std::string> dropped;  ///< for each of the others, why
};

/// Where psi = 0 cuts the edges of the grid, of all pieces that are kept.
std::vector<Vec3> kept_points(const ZeroSetChoice& pieces);

/// A patch of surface this many sample spacings from any sample is a guess of the fit.
inline constexpr double kSupportRadius = 3;

/// That distance, model units: the one place that says how far samples support the surface.
double support_radius(const Domain& domain);

/// Spacing of the grid on which the pieces are counted for a mesh of edge length h: min(h, lattice spacing), of a
/// segmentation min(h, half a voxel), but as coarse as 5e7 nodes in the box ask for.
double counting_spacing(const Domain& domain, double h);

/// Pieces of a level set that no samples back are artefacts of the fit.
///
/// Every sample backs the one piece that is nearest to it (to its cut points), if it is within three sample spacings,
/// or one spacing of the counting grid where that is more. So a false sheet around, inside or across the body gets
/// none of the body's samples. A piece is kept if at least 10 samples back it, and at least a fiftieth of what it would
/// have with as many samples per area as the piece that most samples back: a second body may be scanned seven times
/// as coarsely. The piece that most samples back is kept if it has one. A formula has no artefacts: all is kept.
///
/// @param h      edge length of the mesh to come; the grid has counting_spacing(domain, h)
/// @param cells  of an earlier count of the same psi at a larger h, which need no second search; null: searched
/// Cost: one value of psi per node of the grid (of a level set: per node within its spacing of a sign cell), one
/// nearest-point query per sample and piece whose box it is near. \throw std::length_error  a box too unlike a cube for
/// the grid \throw Cancelled
ZeroSetChoice choose_components(const Domain& domain, double h, const Context& context = {},
                                const SignCells* cells = nullptr);

/// The same for a mesh of these sizes: counted by graded_zero_set() at this share of them.
/// @param finest  the least of the sizes
/// @param cells   have edges of half the longest on which it was counted / sqrt(3)
ZeroSetChoice choose_components(const Domain& domain, const SizeField& sizes, double finest, double share,
                                const Context& context = {}, const SignCells* cells = nullptr);

}  // namespace umtet
