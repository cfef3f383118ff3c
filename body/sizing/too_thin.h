#pragma once

#include <string>
#include <vector>

#include "body/body.h"
#include "body/pieces/zero_set_choice.h"
#include "body/thin_place.h"

namespace umtet {

/// All thin places, and the points of the boundary that they consist of.
struct ThinPlaces {
  double h = 0;                   ///< the edge length they are too thin for
  std::vector<ThinPlace> places;  ///< ascending in h_needed: worst first
  std::vector<Vec3> points;       ///< of psi = 0
  std::vector<double> thickness;  ///< of each point
  std::vector<int> place;         ///< of each point, into places

  bool empty() const { return places.empty(); }
  double h_needed() const { return places.front().h_needed; }  ///< for all of them. \pre !empty()
};

/// A place is too thin if it is thinner than kLeastEdgesAcross on more than this much of the boundary, in h^2: a few
/// samples at a sharp edge, or of noise, do no harm.
inline constexpr double kLeastThinArea = 0.5;

/// What a mesh of edge length h cannot show, before it is made.
///
/// The thickness of psi, as it is cut for h, at the cut points of the pieces that are kept. Thin points half an edge
/// apart or less are one place. The h that a place needs is that of psi with all its detail.
/// @param pieces  of choose_components(domain, h)
/// Cost: some twenty values of psi a cut point. The result does not depend on the number of threads.
/// \throw Cancelled
ThinPlaces find_thin_places(const Domain& domain, const ZeroSetChoice& pieces, double h, const Context& context = {});

/// The places in model coordinates: `shift` is added.
std::vector<ThinPlace> in_model(const ThinPlaces&, const Vec3& shift);

/// The first few in words, a line each, without a newline at the end.
std::string described(const ThinPlaces&, const Vec3& shift);

}  // namespace umtet
