#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "mesh/certify/mid_side_projection.h"
#include "mesh/certify/quadratic_tets.h"

namespace umtet {

/// A tet of second order by ids of the background, on its way to another rank.
struct SentTet {
  std::int64_t id, corner[4], kind[6];  ///< kinds of its mid-sides, a MidSide each
  double place[10][3];                  ///< of its nodes
};

/// A mid-side that was moved, or has become one of another kind.
struct MovedMidSide {
  std::array<std::int64_t, 2> edge;  ///< ids of its corners, the lower one first
  std::int64_t kind;
  double place[3];
};

/// Some tets of a mesh of second order, in which mid-sides are relaxed as in the whole.
class MidSidePatch {
 public:
  /// Around those that it has, over edges. Tets that are there already are passed over.
  void add_ring(const std::vector<SentTet>& tets);
  /// Edges of all tets, ascending.
  std::vector<std::array<std::int64_t, 2>> edges() const;

  struct Relaxed {
    bool has_met_rim = false;  ///< more tets are needed: nothing else holds
    std::vector<MovedMidSide> moved;
    std::size_t n_slid = 0, n_relaxed = 0;  ///< as in SecondOrder
  };
  /// MidSideRelaxation of the tets of the first ring.
  Relaxed relaxed(ImplicitFunctionRef psi, double h, const SecondOrderParams& params) const;

 private:
  struct Member {
    SentTet tet;
    int ring;
  };
  std::map<std::int64_t, Member> tets_;  ///< by id
  int n_rings_ = 0;
};

}  // namespace umtet
