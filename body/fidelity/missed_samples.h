#pragma once

#include <vector>

#include "body/body.h"
#include "body/fidelity/mesh_edge.h"
#include "body/fidelity/mesh_measures.h"

namespace umtet {

/// Converts distances of merged samples to the rms over the original samples: sqrt(d^2 + spread^2). The distances of
/// other samples do not change.
std::vector<double> before_merging(const OrientedPointCloud& cloud, std::vector<double> d);

/// Single noisy samples can be at any distance from the mesh. This number of adjacent samples is a defect.
inline constexpr std::size_t kFewestMissed = 10;
/// Multiple of the noise of a sample above which it may be missed; noise alone exceeds it for one sample in 400.
inline constexpr double kNoisesMissed = 3;
/// Multiple of the noise that one in 150,000 normally distributed samples exceeds.
inline constexpr double kNoisesFar = 4.5;
/// Maximum number of missed defects that a document lists. All are counted.
inline constexpr std::size_t kListedMisses = 100;

/// Returns the part of a certificate about the distances of the samples.
///
/// A sample is missed if its distance from the mesh exceeds kNoisesMissed times its noise, and also exceeds the
/// distance of all face centres from psi = 0, or if it exceeds h. Missed samples within the support radius of each
/// other form one defect, if there are at least kFewestMissed. If there is no such defect, but the rms distance exceeds
/// what noise and flat faces explain, or fewer than 99 % of the samples are within h, the farthest sample is a defect.
///
/// @param d                distance from each sample of the domain to the boundary of the mesh
/// @param flatness_over_h  largest distance of a face centre from psi = 0, in h
/// @return the report, with the defect of the largest distance first
/// Cost: O(n log n) in the number of missed samples.
SampleDistances sample_distances(const Domain& domain, const std::vector<double>& d, const MeshEdge& h,
                                 double flatness_over_h);

}  // namespace umtet
