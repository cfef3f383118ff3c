#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "body/body.h"
#include "body/options.h"
#include "common/context.h"

namespace umtet {

/// Largest h as a share of the diagonal, for mesh.max_deviation: fewer than ten edges along the diagonal do not
/// show the shape of a body, even if it is flat.
inline constexpr double kMostOfDiagonal = .1;

/// Number of edges across thin parts. Boundary faces start to fold where the body or a gap is thinner than about two
/// edges, so h = t / kEdgesAcross, where t is a low quantile of the thickness at the samples.
inline constexpr double kEdgesAcross = 2.2;
/// Largest noise of the samples, in h: psi is fitted on a lattice with a spacing of three times the noise, and contains
/// no finer features.
inline constexpr double kMostNoise = .3;

struct EdgeLength {
  double h;                                  ///< model units
  double least;                              ///< the h for about mesh.max_tets tets if the library chose h, else h
  std::optional<double> of_thin_parts = {};  ///< the h for thin parts, if the noise requires a larger h
  double needed = h;         ///< the h that noise allows and that gives thin parts 2.2 edges, for any number of tets
  bool at_max_tets = false;  ///< mesh.max_tets makes h larger than thin parts require
  /// Approximate share of boundary faces that would remain if edge lengths were proportional to thickness.
  double graded_faces = 1;
};

/// Chooses the edge length of the background mesh.
///
/// The first of these rules that applies determines h:
/// - mesh.h, if it is given;
/// - the h for about mesh.tets tets, if that is given;
/// - h_for_deviation(), if mesh.max_deviation is given, at most a tenth of the diagonal;
/// - min(.015 diagonal, t / 2.2), where t is the 1 % quantile of the thickness at the samples (for a formula .015 of
///   the diagonal of its box). If t / 2.2 makes more than about 1.15 million tets, up to t / 1.9 is used instead. h is
///   at least noise / .3, because samples do not show parts thinner than their noise.
/// The last two rules make at most about mesh.max_tets tets.
/// @param domain  psi keeps the detail that the choice of h required
/// \throw ResourceLimit      mesh.h or mesh.max_deviation requires more than mesh.max_tets tets
/// \throw MeshingImpossible  psi < 0 nowhere, or h is below least_h_in_file()
EdgeLength choose_edge_length(Domain& domain, const BodyOptions& options, const Context& context = {});

/// Returns the default h of a body before the limits by noise and mesh.max_tets; see choose_edge_length().
/// @param of_size   upper bound of h: .015 diagonal
/// @param thin      1 % quantile of the thickness at the samples
/// @param of_large  returns the h for about kTetsOfLargeMesh tets; called if there are thin parts
double edge_length_by(double of_size, double thin, const std::function<double()>& of_large);

/// Number of tets from which a mesh is large: it then has fewer edges across thin parts.
inline constexpr std::int64_t kTetsOfLargeMesh = 1'150'000;

/// Returns the h for about mesh.max_tets tets. \throw MeshingImpossible  psi < 0 nowhere
double least_h_of_max_tets(const Domain& domain, const BodyOptions& options);

/// Returns the least h that the noise of the samples allows: noise / kMostNoise; 0 without noise.
double noise_edge(const Domain& domain);

/// Returns the choice with choice.least raised to least_h_in_file(). \throw MeshingImpossible  choice.h is below it
EdgeLength representable(EdgeLength choice, const Domain& domain);

/// Returns the largest distance by which rounding moves a vertex, model units: a file stores model coordinates as
/// doubles, so the distance grows with the distance from the origin.
double coordinate_rounding(const Domain& domain);

/// Returns the h for which coordinate_rounding() is a millionth of an edge. A mesh with a smaller h is refused.
double least_h_in_file(const Domain& domain);

}  // namespace umtet
