#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "body/regions/region_domain_mesh.h"
#include "reconstruct/level_set/grid.h"

namespace umtet {

/// Makes one mesh of all labels of a segmentation, and of what is around them (label 0 and the space around the image).
/// Every label has a level set of its own (fit_labels()), and a point belongs to the label whose level set is least.
///
/// Without h and a number of tets, three edges fit into the thinnest places of the labels, with 100,000 to 1,000,000
/// tets. A label fails if it has no tet, if its volume differs by more than kLabelVolume from that of its voxels, or if
/// it has another number of pieces.
///
/// @param names  of labels; the others are called label1, label2 ...
/// \pre kind_of(grid) is GridKind::Segmentation
/// \throw UsageError         no label, too many of them, or names that repeat or belong to no label
/// \throw MeshingImpossible  the box is too small
/// \throw Cancelled
RegionBodyMesh mesh_label_regions(const Grid& grid, const std::map<int, std::string>& names,
                                  const RegionBodyOptions& options);

/// The relative difference between the volume of a label and that of its voxels above which the label fails. Flat faces
/// lose a share of the volume of what is thin that falls with the square of h.
inline constexpr double kLabelVolume = .03;

}  // namespace umtet
