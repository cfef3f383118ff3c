#pragma once

#include <string>
#include <vector>

#include "body/body.h"
#include "body/pieces/zero_set_choice.h"
#include "body/thin_place.h"

namespace umtet {

/// All thin places, and the points of psi = 0 that belong to them.
struct ThinPlaces {
  double h = 0;                   ///< edge length for which they are too thin
  std::vector<ThinPlace> places;  ///< in ascending order of h_needed: worst first
  std::vector<Vec3> points;       ///< points of psi = 0
  std::vector<double> thickness;  ///< thickness at each point
  std::vector<int> place;         ///< index into `places` for each point

  bool empty() const { return places.empty(); }
  /// Edge length that suffices for all places. \pre !empty().
  double h_needed() const { return places.front().h_needed; }
};

/// Least area of a thin place, in h^2: a place is too thin if it is thinner than kLeastEdgesAcross on a larger area of
/// the boundary. A few samples at a sharp edge, or noise, are not a thin place.
inline constexpr double kLeastThinArea = 0.5;

/// Predicts the places that a mesh of edge length h cannot resolve.
///
/// It measures the thickness of psi with the detail for h, at the cut points of the kept pieces. Thin points that are
/// at most half an edge apart form one place. The h that a place requires is computed with the full detail of psi.
/// @param pieces  result of choose_components(domain, h)
/// Cost: about twenty values of psi per cut point. The result does not depend on the number of threads.
/// \throw Cancelled
ThinPlaces find_thin_places(const Domain& domain, const ZeroSetChoice& pieces, double h, const Context& context = {});

/// Returns the places in model coordinates: working coordinates plus `shift`.
std::vector<ThinPlace> in_model(const ThinPlaces&, const Vec3& shift);

/// Returns a description of the first few places, one per line, without a newline at the end.
std::string described(const ThinPlaces&, const Vec3& shift);

}  // namespace umtet
