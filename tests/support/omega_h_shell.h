#pragma once

// All of omega_h of an analytic domain as one layer, for tests of what moves shells.

#include <algorithm>
#include <vector>

#include "mesh/core/tet_quality.h"
#include "mesh/implicit/closest_point.h"
#include "mesh/sizes/body_size.h"
#include "mesh/submesh/active_layer.h"
#include "mesh/submesh/submesh.h"
#include "tests/support/domains.h"

namespace umtet::testing {

/// Rings and a greedy colouring for a layer whose V, C and role are set.
inline void complete(ActiveLayer& layer) {
  list_rings(layer);
  layer.colour.assign(layer.V.size(), -1);
  std::vector<bool> taken;
  for (std::size_t i = 0; i < layer.V.size(); ++i) {
    taken.assign(64, false);
    for (int r = layer.ring_begin[i]; r < layer.ring_begin[i + 1]; ++r) {
      for (const int j : layer.C[layer.ring[r]]) {
        if (layer.colour[j] >= 0) taken[layer.colour[j]] = true;
      }
    }
    layer.colour[i] = static_cast<int>(std::find(taken.begin(), taken.end(), false) - taken.begin());
  }
}

/// omega_h: positive vertices are Boundary, the rest is Inner.
inline ActiveLayer omega_h_shell(const AnalyticDomain& domain, double n_tets) {
  const double h = h_for_tets(domain, domain.box, n_tets);
  const Submesh submesh = find_submesh(BackgroundMesh(a15(), domain.box, h), domain);
  ActiveLayer layer;
  layer.V = submesh.mesh.V;
  layer.C = submesh.mesh.C;
  layer.role.assign(layer.V.size(), ActiveLayer::Role::Inner);
  for (const int i : submesh.positive_vertices) layer.role[i] = ActiveLayer::Role::Boundary;
  layer.h = h;
  complete(layer);
  return layer;
}

inline double tet_quality(const ActiveLayer& layer, int t) {
  const Tet& c = layer.C[t];
  return mean_ratio(layer.V[c[0]], layer.V[c[1]], layer.V[c[2]], layer.V[c[3]]);
}

inline double ring_quality(const ActiveLayer& layer, int i) {
  double Q = 1;
  for (int r = layer.ring_begin[i]; r < layer.ring_begin[i + 1]; ++r) {
    Q = std::min(Q, tet_quality(layer, layer.ring[r]));
  }
  return Q;
}

inline double worst_quality(const ActiveLayer& layer) {
  double Q = 1;
  for (std::size_t t = 0; t < layer.C.size(); ++t) Q = std::min(Q, tet_quality(layer, static_cast<int>(t)));
  return Q;
}

/// |psi| / |grad psi|, the distance from psi = 0 to first order.
inline double off_surface(const AnalyticDomain& domain, const Vec3& x) {
  return std::abs(domain.value(x)) / domain.gradient(x).norm();
}

/// The star of vertex 0, the only one that is not Fixed: the background's around a vertex of the given type of A15.
inline ActiveLayer background_star(int type) {
  const double h = 1;
  const BackgroundMesh background(a15(), Box(Vec3::Constant(-2), Vec3::Constant(2)), h);
  std::int64_t centre = type;
  for (std::int64_t v = type; v < background.n_vertices(); v += 8) {
    if (background.position(v).norm() < background.position(centre).norm()) centre = v;
  }
  std::vector<std::int64_t> star, ids = {centre};
  background.star(centre, star);
  ActiveLayer layer;
  layer.h = h;
  for (const std::int64_t t : star) {
    Tet tet;
    const auto corners = background.tet(t);
    for (int k = 0; k < 4; ++k) {
      auto at = std::find(ids.begin(), ids.end(), corners[k]);
      if (at == ids.end()) at = ids.insert(ids.end(), corners[k]);
      tet[k] = static_cast<int>(at - ids.begin());
    }
    layer.C.push_back(tet);
  }
  for (const std::int64_t v : ids) layer.V.push_back(background.position(v));
  layer.role.assign(ids.size(), ActiveLayer::Role::Fixed);
  layer.role[0] = ActiveLayer::Role::Inner;
  complete(layer);
  return layer;
}

}  // namespace umtet::testing
