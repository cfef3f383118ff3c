#pragma once

namespace umtet {

/// Target mean ratio of every tet; smoothing, tangential relaxation and repair use it.
///
/// The configuration of its star limits the worst tet at a boundary vertex. In A15 and Z, .82 is the largest round
/// value that smoothing of the boundary, with the star costs of mesh/classification, reaches at nearly every vertex.
/// The exceptions are few enough to repair. docs/constants.md lists the measures at .80 to .84.
inline constexpr double kQualityTarget = .82;

}  // namespace umtet
