#pragma once

#include <vector>

#include "body/body.h"
#include "body/fidelity/mesh_edge.h"
#include "body/fidelity/mesh_measures.h"

namespace umtet {

/// Distances of merged samples as the rms over those they were merged of: sqrt(d^2 + spread^2). Others stay as they
/// are.
std::vector<double> before_merging(const OrientedPointCloud& cloud, std::vector<double> d);

/// Single samples of noise are off by any distance; so many beside one another are not.
inline constexpr std::size_t kFewestMissed = 10;
/// Of the noise of a sample: one in 400 is farther off.
inline constexpr double kNoisesMissed = 3;
/// Multiple of the noise beyond which one in 150,000 normally distributed samples lies.
inline constexpr double kNoisesFar = 4.5;
/// Places that a document lists. All are counted.
inline constexpr std::size_t kListedMisses = 100;

/// What a certificate says about the distances of the samples.
///
/// A sample is missed if it is farther from the mesh than its noise (kNoisesMissed times) and than the middle of any
/// face is from psi = 0, or than h. Missed samples within the radius of support of each other are one place, if they
/// are kFewestMissed at least. Where the root mean square is farther than that, or 99 % are not within h, the farthest
/// sample is a place in any case.
///
/// @param d        of each sample of the domain to the boundary of the mesh
/// @param flatness_over_h  largest distance of a face's middle from psi = 0, in h
/// @return the farthest place first
/// Cost: O(n log n) in the number of missed samples.
SampleDistances sample_distances(const Domain& domain, const std::vector<double>& d, const MeshEdge& h,
                                 double flatness_over_h);

}  // namespace umtet
