#include "body/fidelity/closed_holes.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "body/pieces/zero_set_choice.h"
#include "common/disjoint_sets.h"
#include "mesh/implicit/surface_distance.h"

namespace umtet {
namespace {

using Edge = std::pair<int, int>;

/// Of the part of a face where a function, linear on it, is positive.
struct FacePart {
  double area = 0;
  Vec3 moment = Vec3::Zero();  ///< area times centroid
  int corner = -1;             ///< one of the face that is in the part; -1: there is none
  /// Where the line on which the function is 0 ends: edges, the vertex in the part first.
  std::optional<std::array<Edge, 2>> line;
};

/// The point of an edge on which the function is 0. \pre w[edge.first] > 0 >= w[edge.second]
Vec3 zero_on(const Edge& edge, const std::vector<Vec3>& V, const std::vector<double>& w) {
  const auto& [a, b] = edge;
  return V[a] + w[a] / (w[a] - w[b]) * (V[b] - V[a]);
}

void add_triangle(const Vec3& a, const Vec3& b, const Vec3& c, double sign, FacePart& part) {
  const double area = sign * (b - a).cross(c - a).norm() / 2;
  part.area += area;
  part.moment += area / 3 * (a + b + c);
}

FacePart positive_part(const Triangle& f, const std::vector<Vec3>& V, const std::vector<double>& w) {
  const auto positive = [&](int k) { return w[f[k % 3]] > 0; };
  const int n = positive(0) + positive(1) + positive(2);
  FacePart part;
  if (n == 0) return part;
  if (n > 1) add_triangle(V[f[0]], V[f[1]], V[f[2]], 1, part);
  if (n == 3) {
    part.corner = f[0];
    return part;
  }
  int alone = 0;  // the corner whose sign is not that of the others
  while (positive(alone) != (n == 1)) ++alone;
  const int a = f[alone], b = f[(alone + 1) % 3], c = f[(alone + 2) % 3];
  part.corner = n == 1 ? a : b;
  part.line = n == 1 ? std::array<Edge, 2>{{{a, b}, {a, c}}} : std::array<Edge, 2>{{{b, a}, {c, a}}};
  const Vec3 p = zero_on((*part.line)[0], V, w), q = zero_on((*part.line)[1], V, w);
  add_triangle(V[a], p, q, n == 1 ? 1 : -1, part);
  return part;
}

/// The largest distance between two of the points.
double diameter(std::vector<Vec3> points) {
  if (points.empty()) return 0;
  const Vec3 middle =
      std::accumulate(points.begin(), points.end(), Vec3(Vec3::Zero())) / static_cast<double>(points.size());
  std::sort(points.begin(), points.end(),
            [&](const Vec3& a, const Vec3& b) { return (a - middle).norm() > (b - middle).norm(); });
  double most = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double reach = (points[i] - middle).norm();
    if (2 * reach <= most) break;
    for (std::size_t j = i + 1; j < points.size() && reach + (points[j] - middle).norm() > most; ++j) {
      most = std::max(most, (points[i] - points[j]).norm());
    }
  }
  return most;
}

/// Sets of vertices that edges join at whose ends w is positive.
DisjointSets joined(const std::vector<Triangle>& faces, const std::vector<double>& w) {
  DisjointSets sets(w.size());
  for (const Triangle& f : faces) {
    for (int k = 0; k < 3; ++k) {
      if (w[f[k]] > 0 && w[f[(k + 1) % 3]] > 0) sets.unite(f[k], f[(k + 1) % 3]);
    }
  }
  return sets;
}

/// support - radius, but 0 where it is positive in gaps that are too small for a hole.
std::vector<double> beyond_support(const std::vector<Triangle>& faces, const std::vector<double>& support,
                                   double radius) {
  std::vector<double> beyond(support);
  for (double& d : beyond) d -= radius;
  DisjointSets sets = joined(faces, beyond);
  std::vector<char> deep(support.size(), 0);
  for (std::size_t v = 0; v < support.size(); ++v) {
    if (support[v] > kLeastHoleDepth * radius) deep[sets.find(static_cast<int>(v))] = 1;
  }
  for (std::size_t v = 0; v < support.size(); ++v) {
    if (beyond[v] > 0 && !deep[sets.find(static_cast<int>(v))]) beyond[v] = 0;
  }
  return beyond;
}

/// By vertex, the depth behind the rim of a hole, positive in it. The samples around it are `radius` outside of the
/// unsupported surface, the rim half a spacing less.
std::vector<double> depths(const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                           const std::vector<double>& support, double radius, const Context& context) {
  const std::vector<double> beyond = beyond_support(faces, support, radius);
  const double reach = (1 - .5 / kSupportRadius) * radius;
  std::vector<Vec3> ends;
  std::vector<Triangle> lines;  // two corners are one
  for (const Triangle& f : faces) {
    const FacePart part = positive_part(f, V, beyond);
    if (!part.line) continue;
    const int k = static_cast<int>(ends.size());
    for (const Edge& edge : *part.line) ends.push_back(zero_on(edge, V, beyond));
    lines.push_back({k, k + 1, k + 1});
  }
  std::vector<double> depth(V.size(), -reach);
  if (lines.empty()) {  // whole pieces, or nothing
    for (std::size_t v = 0; v < V.size(); ++v) depth[v] = beyond[v] > 0 ? reach : -reach;
    return depth;
  }
  std::vector<int> vertices;
  std::vector<Vec3> places;
  for (std::size_t v = 0; v < V.size(); ++v) {
    if (support[v] >= 0) vertices.push_back(static_cast<int>(v)), places.push_back(V[v]);
  }
  const std::vector<double> distance = SurfaceDistance(ends, lines).distances(places, context);
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    depth[vertices[k]] = beyond[vertices[k]] > 0 ? reach + distance[k] : reach - distance[k];
  }
  return depth;
}

/// A hole while its faces are collected.
struct Collected {
  ClosedHole hole;
  Vec3 moment = Vec3::Zero();
  std::vector<Edge> rim;  ///< edges that its rims cross, those of one face together
  std::vector<int> faces;
};

void measure_rims(const Collected& c, const std::vector<Vec3>& V, const std::vector<double>& depth, ClosedHole& hole) {
  std::map<Edge, int> crossings;
  for (const Edge& edge : c.rim) crossings.emplace(edge, static_cast<int>(crossings.size()));
  std::vector<Vec3> points(crossings.size());
  for (const auto& [edge, k] : crossings) points[k] = zero_on(edge, V, depth);
  DisjointSets rims(points.size());
  for (std::size_t i = 0; i < c.rim.size(); i += 2) {
    const int p = crossings.at(c.rim[i]), q = crossings.at(c.rim[i + 1]);
    rims.unite(p, q);
    hole.rim_length += (points[p] - points[q]).norm();
  }
  std::set<int> distinct;
  for (std::size_t k = 0; k < points.size(); ++k) distinct.insert(rims.find(static_cast<int>(k)));
  hole.n_rims = distinct.size();
  hole.rim_diameter = diameter(std::move(points));
}

/// The connected parts of the surface where the depth is positive, by their least vertex.
std::map<int, Collected> collect(const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                                 const std::vector<double>& support, const std::vector<double>& depth) {
  DisjointSets sets = joined(faces, depth);
  std::map<int, Collected> parts;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const FacePart part = positive_part(faces[f], V, depth);
    if (part.corner < 0) continue;
    Collected& c = parts[sets.find(part.corner)];
    c.hole.area += part.area;
    c.moment += part.moment;
    for (const int v : faces[f]) {
      if (depth[v] > 0) c.hole.deepest = std::max(c.hole.deepest, support[v]);
    }
    if (depth[faces[f][0]] + depth[faces[f][1]] + depth[faces[f][2]] > 0) c.faces.push_back(static_cast<int>(f));
    if (part.line) c.rim.insert(c.rim.end(), part.line->begin(), part.line->end());
  }
  return parts;
}

double supported_area(const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                      const std::vector<double>& support) {
  double area = 0;
  for (const auto& [a, b, c] : faces) {
    if (std::min({support[a], support[b], support[c]}) >= 0) area += (V[b] - V[a]).cross(V[c] - V[a]).norm() / 2;
  }
  return area;
}

/// Genus of some of the faces when each of their rims gets a disc: n - (V - E + F + rims) / 2 for n connected parts. A
/// vertex at which fans of faces only touch counts once for each fan.
int closed_genus(const std::vector<Triangle>& faces, const std::vector<char>& is_in) {
  std::map<Edge, std::vector<int>> sides;  // faces at each edge
  int n_faces = 0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (!is_in[f]) continue;
    ++n_faces;
    for (int k = 0; k < 3; ++k) {
      sides[std::minmax(faces[f][k], faces[f][(k + 1) % 3])].push_back(static_cast<int>(f));
    }
  }
  DisjointSets corners(3 * faces.size()), parts(faces.size());
  const auto corner_at = [&](int face, int vertex) {
    const Triangle& f = faces[static_cast<std::size_t>(face)];
    return 3 * face + static_cast<int>(std::find(f.begin(), f.end(), vertex) - f.begin());
  };
  for (const auto& [edge, of_edge] : sides) {
    for (std::size_t k = 1; k < of_edge.size(); ++k) {
      parts.unite(of_edge[0], of_edge[k]);
      for (const int v : {edge.first, edge.second}) corners.unite(corner_at(of_edge[0], v), corner_at(of_edge[k], v));
    }
  }
  DisjointSets rims(3 * faces.size());
  std::set<int> on_rims;
  for (const auto& [edge, of_edge] : sides) {
    if (of_edge.size() != 1) continue;
    const int a = corners.find(corner_at(of_edge[0], edge.first)), b = corners.find(corner_at(of_edge[0], edge.second));
    rims.unite(a, b);
    on_rims.insert(a);
    on_rims.insert(b);
  }
  std::set<int> vertices, components, distinct_rims;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (!is_in[f]) continue;
    components.insert(parts.find(static_cast<int>(f)));
    for (int k = 0; k < 3; ++k) vertices.insert(corners.find(static_cast<int>(3 * f) + k));
  }
  for (const int corner : on_rims) distinct_rims.insert(rims.find(corner));
  const auto chi = static_cast<int>(vertices.size()) - static_cast<int>(sides.size()) + n_faces +
                   static_cast<int>(distinct_rims.size());
  return static_cast<int>(components.size()) - chi / 2;
}

/// The handles that go with what was closed. Where only one line ends each hole and the holes are discs, there are
/// none.
int guessed_handles(const std::vector<Triangle>& faces, const ClosedHoles& found) {
  if (found.holes.empty()) return 0;
  std::vector<char> all(faces.size(), 1), rest(faces.size(), 0);
  for (std::size_t f = 0; f < faces.size(); ++f) rest[f] = found.of_face[f] < 0 ? 1 : 0;
  return std::max(0, closed_genus(faces, all) - closed_genus(faces, rest));
}

/// Distances of the vertices of faces to the nearest sample; -1 at all other vertices.
std::vector<double> support_of(const Domain& domain, const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                               const Context& context) {
  std::vector<double> support(V.size(), -1);
  for (const Triangle& f : faces) {
    for (const int v : f) support[v] = 0;
  }
  std::vector<int> vertices;
  std::vector<Vec3> places;
  for (std::size_t v = 0; v < V.size(); ++v) {
    if (support[v] == 0) vertices.push_back(static_cast<int>(v)), places.push_back(V[v]);
  }
  const std::vector<double> distance = distances_to_samples(domain.cloud.points, places, context);
  for (std::size_t k = 0; k < vertices.size(); ++k) support[vertices[k]] = distance[k];
  return support;
}

}  // namespace

ClosedHoles find_closed_holes(const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                              const std::vector<double>& support, double radius, const Context& context) {
  ClosedHoles found;
  found.of_face.assign(faces.size(), -1);
  const double least = kLeastHoleDepth * radius;
  if (!(radius > 0) || std::none_of(support.begin(), support.end(), [&](double d) { return d > least; })) return found;
  const std::vector<double> depth = depths(V, faces, support, radius, context);
  const std::map<int, Collected> parts = collect(V, faces, support, depth);
  std::vector<const Collected*> holes;
  for (const auto& [vertex, part] : parts) {
    // The rest is of other sheets near by: within the radius of a hole, and of samples of their own.
    if (part.hole.deepest > least && !part.faces.empty()) holes.push_back(&part);
  }
  std::stable_sort(holes.begin(), holes.end(),
                   [](const Collected* a, const Collected* b) { return a->hole.area > b->hole.area; });
  const double whole = supported_area(V, faces, support);
  for (const Collected* c : holes) {
    for (const int f : c->faces) found.of_face[f] = static_cast<int>(found.holes.size());
    ClosedHole& hole = found.holes.emplace_back(c->hole);
    hole.centre = c->moment / hole.area;
    hole.area_fraction = hole.area / whole;
    hole.deepest_over_spacing = kSupportRadius * hole.deepest / radius;
    measure_rims(*c, V, depth, hole);
  }
  return found;
}

ClosedHoles find_closed_holes(const Domain& domain, const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                              const Context& context) {
  return find_closed_holes(V, faces, support_of(domain, V, faces, context), support_radius(domain), context);
}

SupportReport support_report(const Domain& domain, const std::vector<Vec3>& V, const std::vector<Triangle>& faces,
                             const Context& context) {
  const std::vector<double> support = support_of(domain, V, faces, context);
  SupportReport report;
  report.radius = support_radius(domain);
  report.unsupported_area_fraction = unsupported_area_fraction(V, faces, support, report.radius);
  ClosedHoles found = find_closed_holes(V, faces, support, report.radius, context);
  report.n_guessed_handles = guessed_handles(faces, found);
  report.closed_holes = std::move(found.holes);
  report.n_closed_holes = report.closed_holes.size();
  report.n_guessed_pieces = static_cast<std::size_t>(std::count_if(
      report.closed_holes.begin(), report.closed_holes.end(), [](const ClosedHole& h) { return h.n_rims == 0; }));
  if (report.n_closed_holes > kListedHoles) report.closed_holes.resize(kListedHoles);
  for (ClosedHole& hole : report.closed_holes) hole.centre += domain.shift;
  return report;
}

}  // namespace umtet
