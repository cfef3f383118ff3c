#include "mesh/regions/region_certificate.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "common/polled_loops.h"
#include "mesh/certify/boundary_surface.h"
#include "mesh/certify/surface_measures.h"
#include "mesh/core/implicit_function.h"
#include "mesh/core/tet_quality.h"

namespace umtet {
namespace {

/// The sheet between two regions as psi.
struct SheetPsi {
  const RegionDomain* domain;
  int a, b;
  double value(const Vec3& x) const { return domain->sheet(a, b, x); }
  Vec3 gradient(const Vec3& x) const {
    Vec3 g;
    domain->sheet(a, b, x, &g);
    return g;
  }
};

/// A face between two regions, outward from the greater one.
struct Face {
  Triangle corners;
  int region, other;
};

/// The tets of one region, with the vertices that they use.
TetMesh part_of(const TetMesh& mesh, const std::vector<int>& region, int wanted, std::vector<int>& number) {
  TetMesh part;
  number.assign(mesh.V.size(), -1);
  for (std::size_t t = 0; t < mesh.C.size(); ++t) {
    if (region[t] != wanted) continue;
    for (const int v : mesh.C[t]) number[v] = 0;
    part.C.push_back(mesh.C[t]);
  }
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    number[v] = static_cast<int>(part.V.size());
    part.V.push_back(mesh.V[v]);
  }
  for (Tet& t : part.C)
    for (int& v : t) v = number[v];
  return part;
}

/// A face by its sorted corners, with its tet.
struct TetFace {
  Triangle key;
  int tet, opposite;
};

std::vector<TetFace> sorted_faces(const std::vector<Tet>& C) {
  std::vector<TetFace> faces;
  faces.reserve(4 * C.size());
  for (std::size_t t = 0; t < C.size(); ++t) {
    for (int k = 0; k < 4; ++k) {
      Triangle key = {C[t][kTetFace[k][0]], C[t][kTetFace[k][1]], C[t][kTetFace[k][2]]};
      std::sort(key.begin(), key.end());
      faces.push_back({key, static_cast<int>(t), k});
    }
  }
  std::sort(faces.begin(), faces.end(),
            [](const TetFace& a, const TetFace& b) { return std::pair(a.key, a.tet) < std::pair(b.key, b.tet); });
  return faces;
}

Triangle outward(const Tet& t, int opposite) {
  return {t[kTetFace[opposite][0]], t[kTetFace[opposite][1]], t[kTetFace[opposite][2]]};
}

/// The faces between regions, the piece of each tet (tets of one region that are connected by faces), and whether each
/// vertex is on the boundary of the mesh.
std::vector<Face> interface_faces(const TetMesh& mesh, const std::vector<int>& region,
                                  const std::vector<Triangle>& sides, std::vector<int>& piece,
                                  std::vector<char>& is_on_boundary) {
  is_on_boundary.assign(mesh.V.size(), 0);
  const bool has_outside = std::find(region.begin(), region.end(), 0) != region.end();
  const std::vector<TetFace> faces = sorted_faces(mesh.C);
  piece.resize(mesh.C.size());
  std::iota(piece.begin(), piece.end(), 0);
  const auto root = [&](int t) {
    while (piece[t] != t) t = piece[t] = piece[piece[t]];
    return t;
  };
  std::vector<Face> between;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    const TetFace& f = faces[k];
    const bool has_next = k + 1 < faces.size() && faces[k + 1].key == f.key;
    if (has_next) {
      const TetFace& g = faces[++k];
      const int a = region[f.tet], b = region[g.tet];
      if (a == b) {
        const int x = root(f.tet), y = root(g.tet);
        piece[std::max(x, y)] = std::min(x, y);
      } else {
        const TetFace& greater = a > b ? f : g;
        between.push_back({outward(mesh.C[greater.tet], greater.opposite), std::max(a, b), std::min(a, b)});
      }
      while (k + 1 < faces.size() && faces[k + 1].key == f.key) ++k;  // counted by certify() as overused
    } else {
      for (const int v : f.key) is_on_boundary[v] = 1;
      if (!has_outside && !std::binary_search(sides.begin(), sides.end(), f.key))
        between.push_back({outward(mesh.C[f.tet], f.opposite), region[f.tet], 0});
    }
  }
  for (std::size_t t = 0; t < piece.size(); ++t) piece[t] = root(static_cast<int>(t));
  return between;
}

/// The boundary faces with the corners of another one.
std::size_t unshared_faces(const TetMesh& mesh) {
  std::vector<Triangle> faces = boundary_faces(mesh.C, mesh.V.size()).triangles;
  std::vector<int> vertices;
  for (const Triangle& f : faces) vertices.insert(vertices.end(), f.begin(), f.end());
  const auto before = [&](int a, int b) {
    const Vec3 &x = mesh.V[a], &y = mesh.V[b];
    return std::lexicographical_compare(x.data(), x.data() + 3, y.data(), y.data() + 3);
  };
  std::sort(vertices.begin(), vertices.end(), [&](int a, int b) { return before(a, b) || (!before(b, a) && a < b); });
  std::vector<int> first_at(mesh.V.size(), -1);  // the first vertex at the position of each
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const bool is_same = k > 0 && !before(vertices[k - 1], vertices[k]);
    first_at[vertices[k]] = is_same ? first_at[vertices[k - 1]] : vertices[k];
  }
  for (Triangle& f : faces) {
    for (int& v : f) v = first_at[v];
    std::sort(f.begin(), f.end());
  }
  std::sort(faces.begin(), faces.end());
  std::size_t n = 0;
  for (std::size_t k = 0; k < faces.size(); ++k)
    n += (k > 0 && faces[k] == faces[k - 1]) || (k + 1 < faces.size() && faces[k] == faces[k + 1]) ? 1 : 0;
  return n;
}

void measure_faces(const TetMesh& mesh, const std::vector<Face>& faces, const RegionDomain* domain, double h,
                   const Context& context, std::vector<InterfaceMeasures>& interfaces) {
  struct OfFace {
    FaceMeasure face;
    double farthest;  // corner
    std::size_t n_off;
  };
  std::vector<OfFace> measured(faces.size());
  if (domain) {
    polled_parallel_for(faces.size(), kValuesPerPoll, context, [&](std::size_t k) {
      const Face& f = faces[k];
      const SheetPsi psi{domain, f.region, f.other};
      const ImplicitFunctionRef sheet(psi);
      const Vec3 &a = mesh.V[f.corners[0]], &b = mesh.V[f.corners[1]], &c = mesh.V[f.corners[2]];
      OfFace& m = measured[k];
      m.face = measure_face(sheet, a, b, c, h);
      for (const Vec3* x : {&a, &b, &c}) {
        const double d = vertex_distance(sheet, *x) / h;
        m.farthest = std::max(m.farthest, d);
        m.n_off += d <= kVertexTolerance ? 0 : 1;
      }
    });
  }
  std::map<std::pair<int, int>, InterfaceMeasures> of_pair;
  for (std::size_t k = 0; k < faces.size(); ++k) {
    const Face& f = faces[k];
    InterfaceMeasures& m = of_pair[{f.region, f.other}];
    m.region = f.region, m.other = f.other;
    ++m.n_faces;
    m.area += face_area(mesh.V[f.corners[0]], mesh.V[f.corners[1]], mesh.V[f.corners[2]]);
    if (!domain) continue;
    const OfFace& of = measured[k];
    m.max_vertex_distance = std::max(m.max_vertex_distance, of.farthest);
    m.n_off += of.n_off;
    if (of.face.found) {
      m.max_centroid_distance = std::max(m.max_centroid_distance, of.face.distance / h);
      m.min_cos_normal = std::min(m.min_cos_normal, of.face.cos_normal);
    }
    m.n_folded += of.face.found && of.face.cos_normal > 0 ? 0 : 1;
  }
  for (const auto& [pair, m] : of_pair) interfaces.push_back(m);
}

}  // namespace

RegionCertificate certify_regions(const TetMesh& mesh, const std::vector<int>& region, const RegionDomain* domain,
                                  double h, const Context& context, const std::vector<Triangle>& sides) {
  if (region.size() != mesh.C.size()) throw std::invalid_argument("one region for each tet");
  if (std::any_of(region.begin(), region.end(), [&](int r) { return r < 0 || (domain && r >= kMostRegions); }))
    throw std::invalid_argument("regions are numbers from 0, and to " + std::to_string(kMostRegions - 1) +
                                " with a domain");
  RegionCertificate made;
  CertificateInput input;
  input.mesh = &mesh;
  input.h = h;
  input.context = context;
  made.whole = certify(input);
  std::vector<int> piece;
  std::vector<char> is_on_boundary;
  const std::vector<Face> faces = interface_faces(mesh, region, sides, piece, is_on_boundary);
  std::vector<double> least;  // by region
  for (const int r : region)
    if (static_cast<std::size_t>(r) >= least.size()) least.resize(static_cast<std::size_t>(r) + 1, 1);
  for (std::size_t t = 0; t < mesh.C.size(); ++t)
    if (std::none_of(mesh.C[t].begin(), mesh.C[t].end(), [&](int v) { return is_on_boundary[v] != 0; }))
      least[region[t]] = std::min(least[region[t]], mean_ratio(mesh, mesh.C[t]));
  std::vector<int> present = region, number;
  std::sort(present.begin(), present.end());
  present.erase(std::unique(present.begin(), present.end()), present.end());
  for (const int r : present) {
    const TetMesh part = part_of(mesh, region, r, number);
    input.mesh = &part;
    RegionMeasures m{.region = r, .certificate = certify(input)};
    m.min_quality_off_boundary = least[r];
    for (std::size_t t = 0; t < piece.size(); ++t) m.n_pieces += region[t] == r && piece[t] == static_cast<int>(t);
    made.regions.push_back(std::move(m));
  }
  measure_faces(mesh, faces, domain, made.whole.h, context, made.interfaces);
  made.n_unshared_faces = unshared_faces(mesh);
  return made;
}

std::vector<std::string> failures(const RegionCertificate& certificate, int n_regions,
                                  const std::vector<std::string>& names) {
  const auto name_of = [&](int r) {
    return names.empty() ? "region " + std::to_string(r) : names[static_cast<std::size_t>(r)];
  };
  const auto between = [&](const InterfaceMeasures& m) {
    return " between " + name_of(m.region) + " and " + name_of(m.other);
  };
  std::vector<std::string> list = invalidities(certificate.whole);
  for (int r = 1; r < n_regions; ++r) {
    const bool is_there = std::any_of(certificate.regions.begin(), certificate.regions.end(),
                                      [&](const RegionMeasures& m) { return m.region == r; });
    if (!is_there) list.push_back(name_of(r) + " has no tet");
  }
  if (certificate.n_unshared_faces > 0)
    list.push_back(std::to_string(certificate.n_unshared_faces) +
                   " boundary faces lie on another one without sharing its vertices: regions touch, but are not "
                   "connected");
  for (const InterfaceMeasures& m : certificate.interfaces) {
    if (m.n_off > 0)
      list.push_back(std::to_string(m.n_off) + " corners of faces" + between(m) + " are off their sheet");
    if (m.n_folded > 0) list.push_back(std::to_string(m.n_folded) + " faces" + between(m) + " are folded over");
  }
  return list;
}

}  // namespace umtet
