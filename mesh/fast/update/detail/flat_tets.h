#pragma once

#include <algorithm>
#include <cmath>

#include "mesh/core/max_min.h"
#include "mesh/core/tet_quality.h"
#include "mesh/submesh/active_layer.h"

namespace umtet::detail {

/// Calls go_back(v) for the corners of tets below a mean ratio, until no corner of such a tet satisfies has_left(v).
template <class HasLeft, class GoBack>
void go_back_where_flat(const ActiveLayer& layer, double least_quality, const HasLeft& has_left,
                        const GoBack& go_back) {
  const double least_f = f_of_quality(least_quality);
  const auto is_flat = [&](const Tet& t) {
    const Vec3 &a = layer.V[t[0]], &b = layer.V[t[1]], &c = layer.V[t[2]], &d = layer.V[t[3]];
    const double V = volume6(a, b, c, d), L = sum_of_squared_edges(a, b, c, d);
    return !(V * std::abs(V) >= least_f * (L * L * L));
  };
  // A vertex that goes back may make another tet flat.
  for (bool again = true; again;) {
    again = false;
    for (const Tet& t : layer.C) {
      if (!is_flat(t) || std::none_of(t.begin(), t.end(), has_left)) continue;
      again = true;
      for (const int v : t) go_back(v);
    }
  }
}

}  // namespace umtet::detail
