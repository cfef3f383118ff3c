#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "body/body.h"
#include "body/options.h"
#include "common/context.h"

namespace umtet {

/// Of h, for mesh.max_deviation: with fewer than ten edges along its diagonal there is little left of a shape, however
/// flat it is.
inline constexpr double kMostOfDiagonal = .1;

/// Boundary faces start to fold where the body or a gap is thinner than about two edges: h is the thickness that a
/// share of the samples falls below, over this.
inline constexpr double kEdgesAcross = 2.2;
/// Noise of the samples over h, at most: psi is fitted on a lattice of three times the noise, and has nothing finer.
inline constexpr double kMostNoise = .3;

struct EdgeLength {
  double h;      ///< model units
  double least;  ///< the h that makes about mesh.max_tets tets if the choice of h was left to us, else h
  std::optional<double> of_thin_parts = {};  ///< where noise decided: what these alone would have asked for
  double needed = h;         ///< that noise allows and that gives thin parts 2.2 edges, however many tets that makes
  bool at_max_tets = false;  ///< mesh.max_tets keeps h larger than thin parts ask for
  double graded_faces = 1;   ///< about the share of boundary faces that edges in proportion to thickness would make
};

/// The edge length of the background mesh.
///
/// mesh.h if given; else the h that makes about mesh.tets tets; else that of h_for_deviation() for mesh.max_deviation,
/// at most a tenth of the diagonal; else min(.015 diagonal, t / 2.2), where t is the thickness that 1 % of the samples
/// fall below (a formula: .015 diagonal of its box); where t / 2.2 makes more than about 1.15 million tets, up to t
/// / 1.9 instead; but never below noise / .3: where samples are as far off as a part is thick, they do not show it. The
/// last two make no more than about mesh.max_tets tets.
/// @param domain  where psi has to be cut to choose h, it stays cut
/// \throw ResourceLimit      mesh.h or mesh.max_deviation asks for more than mesh.max_tets tets
/// \throw MeshingImpossible  psi < 0 nowhere, or an h below least_h_in_file()
EdgeLength choose_edge_length(Domain& domain, const BodyOptions& options, const Context& context = {});

/// The default h of a body, as far as neither noise nor mesh.max_tets decides: see choose_edge_length().
/// @param of_size   .015 diagonal
/// @param thin      thickness that 1 % of the samples fall below
/// @param of_large  the h of about kTetsOfLargeMesh tets; called where there are thin parts
double edge_length_by(double of_size, double thin, const std::function<double()>& of_large);

/// So many tets are a large mesh, in which fewer edges across a thin part have to do.
inline constexpr std::int64_t kTetsOfLargeMesh = 1'150'000;

/// The h at which about mesh.max_tets tets are made. \throw MeshingImpossible  psi < 0 nowhere
double least_h_of_max_tets(const Domain& domain, const BodyOptions& options);

/// The h of which the noise of the samples is as much as it may be: .3; 0 without noise.
double noise_edge(const Domain& domain);

/// The choice with least_h_in_file() as the least. \throw MeshingImpossible  its h is below that
EdgeLength representable(EdgeLength choice, const Domain& domain);

/// A file holds model coordinates rounded to double: far from the origin that alone moves a vertex off psi = 0, by up
/// to this much (model units).
double coordinate_rounding(const Domain& domain);

/// The h below which that is more than a millionth of an edge: such a mesh is refused.
double least_h_in_file(const Domain& domain);

}  // namespace umtet
