#pragma once

// All of omega_h of an analytic domain as one shell, for tests of what moves shells.

#include <algorithm>
#include <vector>

#include "mesh/background/body_size.h"
#include "mesh/implicit/closest_point.h"
#include "mesh/submesh/active_layer.h"
#include "mesh/submesh/submesh.h"
#include "mesh/core/tet_quality.h"
#include "tests/support/domains.h"

namespace umtet::testing {

/// Rings and a greedy colouring for a shell whose V, C and role are set.
inline void complete(Shell& shell) {
  list_rings(shell);
  shell.colour.assign(shell.V.size(), -1);
  std::vector<bool> taken;
  for (std::size_t i = 0; i < shell.V.size(); ++i) {
    taken.assign(64, false);
    for (int r = shell.ring_begin[i]; r < shell.ring_begin[i + 1]; ++r) {
      for (const int j : shell.C[shell.ring[r]]) {
        if (shell.colour[j] >= 0) taken[shell.colour[j]] = true;
      }
    }
    shell.colour[i] = static_cast<int>(std::find(taken.begin(), taken.end(), false) - taken.begin());
  }
}

/// omega_h: positive vertices are Boundary, the rest is Inner.
inline Shell omega_h_shell(const AnalyticDomain& domain, double n_tets) {
  const double h = h_for_tets(domain, domain.box, n_tets);
  const Submesh submesh = find_submesh(BackgroundMesh(a15(), domain.box, h), domain);
  Shell shell;
  shell.V = submesh.mesh.V;
  shell.C = submesh.mesh.C;
  shell.role.assign(shell.V.size(), Shell::Role::Inner);
  for (const int i : submesh.positive_vertices) shell.role[i] = Shell::Role::Boundary;
  shell.h = h;
  complete(shell);
  return shell;
}

inline double tet_quality(const Shell& shell, int t) {
  const Tet& c = shell.C[t];
  return mean_ratio(shell.V[c[0]], shell.V[c[1]], shell.V[c[2]], shell.V[c[3]]);
}

inline double ring_quality(const Shell& shell, int i) {
  double Q = 1;
  for (int r = shell.ring_begin[i]; r < shell.ring_begin[i + 1]; ++r) {
    Q = std::min(Q, tet_quality(shell, shell.ring[r]));
  }
  return Q;
}

inline double worst_quality(const Shell& shell) {
  double Q = 1;
  for (std::size_t t = 0; t < shell.C.size(); ++t) Q = std::min(Q, tet_quality(shell, static_cast<int>(t)));
  return Q;
}

/// |psi| / |grad psi|, the distance from psi = 0 to first order.
inline double off_surface(const AnalyticDomain& domain, const Vec3& x) {
  return std::abs(domain.value(x)) / domain.gradient(x).norm();
}

/// The star of vertex 0, the only one that is not Fixed: the background's around a vertex of the given type of A15.
inline Shell background_star(int type) {
  const double h = 1;
  const BackgroundMesh background(a15(), Box(Vec3::Constant(-2), Vec3::Constant(2)), h);
  std::int64_t centre = type;
  for (std::int64_t v = type; v < background.n_vertices(); v += 8) {
    if (background.position(v).norm() < background.position(centre).norm()) centre = v;
  }
  std::vector<std::int64_t> star, ids = {centre};
  background.star(centre, star);
  Shell shell;
  shell.h = h;
  for (const std::int64_t t : star) {
    Tet tet;
    const auto corners = background.tet(t);
    for (int k = 0; k < 4; ++k) {
      auto at = std::find(ids.begin(), ids.end(), corners[k]);
      if (at == ids.end()) at = ids.insert(ids.end(), corners[k]);
      tet[k] = static_cast<int>(at - ids.begin());
    }
    shell.C.push_back(tet);
  }
  for (const std::int64_t v : ids) shell.V.push_back(background.position(v));
  shell.role.assign(ids.size(), Shell::Role::Fixed);
  shell.role[0] = Shell::Role::Inner;
  complete(shell);
  return shell;
}

}  // namespace umtet::testing
