#include "mesh/embedding/triangle_intersection.h"

#include <algorithm>
#include <array>

#include "mesh/core/orientation.h"

namespace umtet {
namespace {

struct Corners {
  const Vec3 &a, &b, &c;
};

/// An axis along which the triangle is not seen from its edge.
int axis_of(const Corners& t) {
  for (int axis = 0; axis < 2; ++axis) {
    if (projected_orientation_sign(t.a, t.b, t.c, axis) != 0) return axis;
  }
  return 2;
}

bool in_range(const Vec3& a, const Vec3& b, const Vec3& x, int axis) {
  for (int k = 0; k < 3; ++k) {
    if (k != axis && (x[k] < std::min(a[k], b[k]) || x[k] > std::max(a[k], b[k]))) return false;
  }
  return true;
}

/// Closed segments in the plane that is left without an axis.
bool segments_meet(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b, int axis) {
  const int s1 = projected_orientation_sign(p, q, a, axis), s2 = projected_orientation_sign(p, q, b, axis);
  const int s3 = projected_orientation_sign(a, b, p, axis), s4 = projected_orientation_sign(a, b, q, axis);
  if (s1 * s2 < 0 && s3 * s4 < 0) return true;
  return (s1 == 0 && in_range(p, q, a, axis)) || (s2 == 0 && in_range(p, q, b, axis)) ||
         (s3 == 0 && in_range(a, b, p, axis)) || (s4 == 0 && in_range(a, b, q, axis));
}

bool is_within(const Vec3& x, const Corners& t, int axis) {
  const int s1 = projected_orientation_sign(t.a, t.b, x, axis), s2 = projected_orientation_sign(t.b, t.c, x, axis),
            s3 = projected_orientation_sign(t.c, t.a, x, axis);
  return (s1 >= 0 && s2 >= 0 && s3 >= 0) || (s1 <= 0 && s2 <= 0 && s3 <= 0);
}

/// A segment and a triangle in one plane.
bool meet_in_plane(const Vec3& p, const Vec3& q, const Corners& t) {
  const int axis = axis_of(t);
  return is_within(p, t, axis) || segments_meet(p, q, t.a, t.b, axis) || segments_meet(p, q, t.b, t.c, axis) ||
         segments_meet(p, q, t.c, t.a, axis);
}

/// A closed segment and a closed triangle. @param sp, sq  on which side of the triangle's plane p and q are
bool meet(const Vec3& p, const Vec3& q, int sp, int sq, const Corners& t) {
  if (sp * sq > 0) return false;
  if (sp == 0 && sq == 0) return meet_in_plane(p, q, t);
  const int s1 = orientation_sign(p, q, t.a, t.b), s2 = orientation_sign(p, q, t.b, t.c),
            s3 = orientation_sign(p, q, t.c, t.a);
  return (s1 >= 0 && s2 >= 0 && s3 >= 0) || (s1 <= 0 && s2 <= 0 && s3 <= 0);
}

using Sides = std::array<int, 3>;

Sides sides_of(const Corners& t, const std::vector<Vec3>& V, const Triangle& g) {
  return {orientation_sign(t.a, t.b, t.c, V[g[0]]), orientation_sign(t.a, t.b, t.c, V[g[1]]),
          orientation_sign(t.a, t.b, t.c, V[g[2]])};
}

bool is_off(const Sides& s) { return (s[0] > 0 && s[1] > 0 && s[2] > 0) || (s[0] < 0 && s[1] < 0 && s[2] < 0); }

bool disjoint_indices_meet(const std::vector<Vec3>& V, const Triangle& f, const Triangle& g) {
  const Corners t{V[f[0]], V[f[1]], V[f[2]]}, u{V[g[0]], V[g[1]], V[g[2]]};
  const Sides of_g = sides_of(t, V, g);
  if (is_off(of_g)) return false;
  const Sides of_f = sides_of(u, V, f);
  if (is_off(of_f)) return false;
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    if (meet(V[g[k]], V[g[next]], of_g[k], of_g[next], t)) return true;
    if (meet(V[f[k]], V[f[next]], of_f[k], of_f[next], u)) return true;
  }
  return false;
}

/// Both contain vertex v. Their intersection is convex: where it is more than v, it reaches the edge of one that is
/// opposite to v.
bool meet_beyond_vertex(const std::vector<Vec3>& V, const Triangle& f, const Triangle& g, int i, int j) {
  const Corners t{V[f[0]], V[f[1]], V[f[2]]}, u{V[g[0]], V[g[1]], V[g[2]]};
  const Vec3 &c = V[g[(j + 1) % 3]], &d = V[g[(j + 2) % 3]];
  const int sc = orientation_sign(t.a, t.b, t.c, c), sd = orientation_sign(t.a, t.b, t.c, d);
  if (sc * sd > 0) return false;
  if (meet(c, d, sc, sd, t)) return true;
  const Vec3 &a = V[f[(i + 1) % 3]], &b = V[f[(i + 2) % 3]];
  return meet(a, b, orientation_sign(u.a, u.b, u.c, a), orientation_sign(u.a, u.b, u.c, b), u);
}

/// Both contain the edge v w: they meet beyond it if they are in one plane, on one side of it.
bool meet_beyond_edge(const std::vector<Vec3>& V, const Triangle& f, int i, int apex_of_g) {
  const Vec3 &a = V[f[i]], &v = V[f[(i + 1) % 3]], &w = V[f[(i + 2) % 3]], &b = V[apex_of_g];
  if (orientation_sign(v, w, a, b) != 0) return false;
  const int axis = axis_of({v, w, a});
  return projected_orientation_sign(v, w, a, axis) == projected_orientation_sign(v, w, b, axis);
}

}  // namespace

int projected_orientation_sign(const Vec3& a, const Vec3& b, const Vec3& c, int axis) {
  // The tet over the flat triangle, its apex straight above a: no coordinate is rounded.
  Vec3 p = a, q = b, r = c;
  p[axis] = q[axis] = r[axis] = 0;
  Vec3 apex = p;
  apex[axis] = 1;
  return orientation_sign(p, q, r, apex);
}

bool meet_beyond_shared(const std::vector<Vec3>& V, const Triangle& f, const Triangle& g) {
  int n_shared = 0, last_f = 0, last_g = 0, sum_f = 0, sum_g = 0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (f[i] != g[j]) continue;
      ++n_shared;
      last_f = i, last_g = j;
      sum_f += i, sum_g += j;
    }
  }
  switch (n_shared) {
    case 0:
      return disjoint_indices_meet(V, f, g);
    case 1:
      return meet_beyond_vertex(V, f, g, last_f, last_g);
    default:
      return meet_beyond_edge(V, f, 3 - sum_f, g[3 - sum_g]);
  }
}

}  // namespace umtet
