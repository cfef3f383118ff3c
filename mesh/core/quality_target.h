#pragma once

namespace umtet {

/// The mean ratio that every tet is to reach; smoothing, tangential relaxation and repair take it from here.
///
/// The worst tet at a boundary vertex is limited by the configuration of its star. In A15 and Z, .82 is the largest
/// round value that smoothing of the boundary, with the star costs of mesh/classification, reaches at nearly every
/// vertex; what remains is few enough to repair. docs/constants.md has the numbers at .80 to .84.
inline constexpr double kQualityTarget = .82;

}  // namespace umtet
