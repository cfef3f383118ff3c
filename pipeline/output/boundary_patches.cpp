#include "pipeline/output/boundary_patches.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <tuple>

#include "body/fidelity/closed_holes.h"
#include "body/fidelity/patch_measures.h"
#include "common/disjoint_sets.h"
#include "mesh/io/patches.h"
#include "mesh/io/planar_pieces.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/meshing/made_mesh.h"
#include "reconstruct/cloud/transfer/label_votes.h"

namespace umtet {
namespace {

constexpr Option kLabelNames{keys::output::label_names};

// Number of samples with a wrong label that make an island: a majority of the voters. Islands smaller than their area
// are removed.
constexpr int kIslandSamples = kVoters / 2 + 1;
// Minimum area of a plane, in mean faces. It is about the number of faces around a vertex and its neighbours, the
// minimum that distinguishes flat from round: with fewer, single faces of a sphere would be planes.
constexpr double kLeastPlane = 20;

std::string name_of(int label, const std::map<int, std::string>& names) {
  const auto found = names.find(label);
  if (found != names.end()) return found->second;
  return label < 0 ? fmt::format("patch_m{}", -static_cast<long>(label)) : fmt::format("patch_{}", label);
}

/// Returns the patches of the existing labels in ascending order.
std::vector<MeshPart> label_patches(const std::vector<int>& labels, const std::map<int, std::string>& names) {
  long free = std::max(0, labels.back());
  std::vector<MeshPart> patches;
  for (const int label : labels) {
    const long number = label > 0 ? label : ++free;
    if (number >= std::numeric_limits<int>::max())
      throw UsageError("labels beyond 2147483646 cannot be numbers in files");
    patches.push_back({name_of(label, names), static_cast<int>(number)});
  }
  return patches;
}

constexpr const char *kWalls = "walls", *kClosedHoles = "closed_holes";

bool has_walls(const std::vector<char>& at_wall) {
  return std::find(at_wall.begin(), at_wall.end(), 1) != at_wall.end();
}

/// Returns false if nothing is flat except walls.
bool divide_by_planes(SolverMesh& mesh, const std::vector<char>& at_wall, double angle) {
  const FaceGeometry faces = face_geometry(mesh);
  const double area = std::accumulate(faces.area.begin(), faces.area.end(), 0.);
  const double least = kLeastPlane * area / static_cast<double>(mesh.n_faces());
  std::vector<int> plane = planar_pieces(mesh, angle, least);
  const int n = *std::max_element(plane.begin(), plane.end()) + 1;
  std::vector<char> plane_at_wall(n, 0);
  for (std::size_t f = 0; f < at_wall.size(); ++f) {
    if (plane[f] >= 0) plane_at_wall[plane[f]] |= at_wall[f];
  }
  int n_planes = 0, n_walls = 0;
  std::vector<MeshPart> patches;
  for (int p = 0; p < n; ++p) {
    const std::string name =
        plane_at_wall[p] ? fmt::format("{}_{}", kWalls, ++n_walls) : fmt::format("plane_{}", ++n_planes);
    patches.push_back({name, p + 2});
  }
  if (n_planes == 0) return false;
  if (std::find(plane.begin(), plane.end(), -1) != plane.end()) patches.push_back({"rest", n + 2});
  for (int& p : plane) p = p < 0 ? n : p;
  set_patches(mesh, std::move(plane), std::move(patches));
  return true;
}

std::vector<int> distinct(std::vector<int> labels) {
  std::sort(labels.begin(), labels.end());
  labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
  return labels;
}

void divide_by_labels(SolverMesh& mesh, const std::vector<char>& at_wall, const OrientedPointCloud& cloud,
                      const Parameters& parameters, const std::vector<std::string>& names_of_file, const Warn& warn) {
  std::map<int, std::string> names = parse_label_names(parameters.output().label_names);
  const std::vector<int> in_cloud = distinct(cloud.labels);
  for (const auto& [label, name] : names) {
    if (has_walls(at_wall) && lower_case(name) == kWalls) {
      throw UsageError({Setting(kLabelNames, fmt::format("{}={}", label, name)),
                        ": this name is reserved for the faces at the walls of the box"});
    }
    if (std::binary_search(in_cloud.begin(), in_cloud.end(), label)) continue;
    throw UsageError({Setting(kLabelNames, fmt::format("{}={}", label, name)),
                      fmt::format(": no point has this label; the labels are {}", fmt::join(in_cloud, ", "))});
  }
  add_names_of_file(names_of_file, names);
  const FaceGeometry faces = face_geometry(mesh);
  const auto is_wall = [&](std::size_t f) { return !at_wall.empty() && at_wall[f]; };
  std::vector<int> labels = vote_labels(cloud, faces.centroid, faces.normal);
  double least = parameters.output().label_min_area;
  if (least < 0) {
    double area = 0;
    for (std::size_t f = 0; f < faces.area.size(); ++f) area += is_wall(f) ? 0 : faces.area[f];
    least = kIslandSamples * area / static_cast<double>(cloud.points.size());
  }
  absorb_islands(mesh, least, labels);
  std::vector<int> of_cloud;
  for (std::size_t f = 0; f < labels.size(); ++f) {
    if (!is_wall(f)) of_cloud.push_back(labels[f]);
  }
  const std::vector<int> left = distinct(std::move(of_cloud));
  for (const int label : in_cloud) {
    if (std::binary_search(left.begin(), left.end(), label)) continue;
    warn(fmt::format("no boundary face has label {} ({}): too few samples for faces of this size", label,
                     name_of(label, names)));
  }
  if (left.empty()) return;
  std::vector<MeshPart> patches = label_patches(left, names);
  for (std::size_t f = 0; f < labels.size(); ++f) {
    const auto at = is_wall(f) ? left.end() : std::lower_bound(left.begin(), left.end(), labels[f]);
    labels[f] = static_cast<int>(at - left.begin());
  }
  if (has_walls(at_wall)) {
    const auto by_number = [](const MeshPart& a, const MeshPart& b) { return a.number < b.number; };
    patches.push_back({kWalls, std::max_element(patches.begin(), patches.end(), by_number)->number + 1});
  }
  set_patches(mesh, std::move(labels), std::move(patches));
}

std::vector<char> faces_at_walls(const SolverMesh& mesh, const MeshFile& file) {
  const auto found = file.point_data.find(kAtWall);
  if (found == file.point_data.end()) return {};
  const auto* wall = std::get_if<std::vector<std::uint8_t>>(&found->second);
  std::vector<char> at_wall(mesh.n_faces());
  for (std::size_t f = 0; wall && f < at_wall.size(); ++f) {
    const std::array<int, 6> face = mesh.face(f);
    at_wall[f] = std::all_of(face.begin(), face.begin() + 3, [&](int v) { return (*wall)[v]; });
  }
  return at_wall;
}

std::vector<char> faces_in_holes(const SolverMesh& mesh, const MeshFile& file,
                                 const std::optional<SupportReport>& support) {
  const auto found = file.point_data.find("support");
  if (!support || support->n_closed_holes == 0 || found == file.point_data.end()) return {};
  const auto* distance = std::get_if<std::vector<double>>(&found->second);
  if (!distance) return {};
  std::vector<Triangle> faces;
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
    const std::array<int, 6> face = mesh.face(f);
    faces.push_back({face[0], face[1], face[2]});
  }
  const ClosedHoles holes = find_closed_holes(file.mesh.V, faces, *distance, support->radius, until_interrupted());
  std::vector<char> in_holes(faces.size());
  std::transform(holes.of_face.begin(), holes.of_face.end(), in_holes.begin(), [](int hole) { return hole >= 0; });
  return in_holes;
}

/// The edges between faces of two patches, as curves that end where more than two patches meet.
std::vector<MeshCurve> curves_between(const SolverMesh& mesh) {
  struct Edge {
    std::array<int, 2> ends, patches;
  };
  std::map<std::array<int, 2>, int> seen;
  std::vector<Edge> edges;
  std::map<int, std::set<std::array<int, 2>>> pairs;  // of patches, by vertex
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
    const std::array<int, 6> face = mesh.face(f);
    for (int k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(face[k], face[(k + 1) % 3]);
      const auto [at, is_new] = seen.try_emplace({a, b}, mesh.face_patch[f]);
      if (is_new || at->second == mesh.face_patch[f]) continue;
      const auto [p, q] = std::minmax(at->second, mesh.face_patch[f]);
      edges.push_back({{a, b}, {p, q}});
      for (const int v : {a, b}) pairs[v].insert({p, q});
    }
  }
  std::sort(edges.begin(), edges.end(),
            [](const Edge& a, const Edge& b) { return std::tie(a.patches, a.ends) < std::tie(b.patches, b.ends); });
  DisjointSets connected(edges.size());
  std::map<std::pair<std::array<int, 2>, int>, int> first;  // edge of a pair of patches at a vertex
  for (std::size_t e = 0; e < edges.size(); ++e) {
    for (const int v : edges[e].ends) {
      if (pairs[v].size() > 1) continue;
      const auto [at, is_new] = first.try_emplace({edges[e].patches, v}, static_cast<int>(e));
      if (!is_new) connected.unite(static_cast<int>(e), at->second);
    }
  }
  std::map<int, std::size_t> number;
  std::vector<MeshCurve> curves;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto [at, is_new] = number.try_emplace(connected.find(static_cast<int>(e)), curves.size());
    if (is_new) {
      const int k = static_cast<int>(curves.size()) + 1;
      curves.push_back({{fmt::format("curve_{}", k), k}, {}});
    }
    curves[at->second].edges.push_back(edges[e].ends);
  }
  return curves;
}

void divide_by_body(SolverMesh& mesh, const std::vector<int>& of_body) {
  const std::vector<int> all = distinct(of_body);
  if (all.size() < 2) return;
  std::vector<MeshPart> patches;
  for (const int p : all) {
    // The body keeps the number 1, which it also has without patches.
    patches.push_back({p < 0 ? "rest" : fmt::format("patch_{}", p + 1), static_cast<int>(patches.size()) + 2});
  }
  std::vector<int> face_patch;
  for (const int p : of_body)
    face_patch.push_back(static_cast<int>(std::lower_bound(all.begin(), all.end(), p) - all.begin()));
  set_patches(mesh, std::move(face_patch), std::move(patches));
  set_curves(mesh, curves_between(mesh));
}

void divide_but_holes(SolverMesh& mesh, const MarkedFaces& marked, const OrientedPointCloud& cloud,
                      const Parameters& parameters, const std::vector<std::string>& names_of_file, const Warn& warn) {
  const std::vector<char>& at_wall = marked.at_wall;
  if (!cloud.labels.empty()) return divide_by_labels(mesh, at_wall, cloud, parameters, names_of_file, warn);
  if (!parameters.output().label_names.empty()) {
    throw UsageError(
        {kLabelNames, ": the points have no labels (PLY property label, PCD field label, or a last column)"});
  }
  const double angle = parameters.output().patch_angle, planar = parameters.output().patch_planar;
  if (planar > 0 && mesh.n_faces() > 0) {
    if (divide_by_planes(mesh, at_wall, planar)) return;
    warn(fmt::format("no part of the boundary is flat within {} degrees", planar));
  }
  if (!marked.of_body.empty() && angle == 0) return divide_by_body(mesh, marked.of_body);
  std::vector<int> pieces = smooth_pieces(mesh, angle > 0 ? angle : 180);
  const int n = pieces.empty() ? 0 : *std::max_element(pieces.begin(), pieces.end()) + 1;
  if (n < 2) return;
  std::vector<char> piece_at_wall(n, 0);
  for (std::size_t f = 0; f < at_wall.size(); ++f) piece_at_wall[pieces[f]] |= at_wall[f];
  const auto n_walls = std::count(piece_at_wall.begin(), piece_at_wall.end(), 1);
  std::vector<int> patch_of(n);
  std::vector<MeshPart> patches;
  for (const bool walls : {false, true}) {
    const std::string name = walls ? kWalls : angle > 0 ? "region" : kWholeBoundary;
    for (int p = 0, k = 1; p < n; ++p) {
      if (piece_at_wall[p] != walls) continue;
      patch_of[p] = static_cast<int>(patches.size());
      // The body keeps the number 1, which it also has without patches.
      patches.push_back({walls && n_walls == 1 ? name : fmt::format("{}_{}", name, k++), patch_of[p] + 2});
    }
  }
  for (int& piece : pieces) piece = patch_of[piece];
  set_patches(mesh, std::move(pieces), std::move(patches));
}

}  // namespace

void take_holes(SolverMesh& mesh, const std::vector<char>& in_holes, const Warn& warn) {
  if (std::find(in_holes.begin(), in_holes.end(), 1) == in_holes.end()) return;
  std::vector<int> n_left(mesh.patches.size(), 0);
  for (std::size_t f = 0; f < in_holes.size(); ++f) n_left[mesh.face_patch[f]] += in_holes[f] ? 0 : 1;
  int number = mesh.body.number;
  std::vector<int> index(mesh.patches.size(), -1);
  std::vector<MeshPart> patches;
  for (std::size_t p = 0; p < mesh.patches.size(); ++p) {
    MeshPart part = mesh.patches[p];
    number = std::max(number, part.number);
    if (n_left[p] == 0) {
      warn(fmt::format("no boundary face is left in {}: all are in {}", part.name, kClosedHoles));
      continue;
    }
    // If there are several patches, none has the name of all patches together.
    if (part.name == kWholeBoundary) part.name += "_1";
    index[p] = static_cast<int>(patches.size());
    patches.push_back(std::move(part));
  }
  patches.push_back({kClosedHoles, number + 1});
  std::vector<int> face_patch(mesh.n_faces());
  for (std::size_t f = 0; f < face_patch.size(); ++f) {
    face_patch[f] = in_holes[f] ? static_cast<int>(patches.size()) - 1 : index[mesh.face_patch[f]];
  }
  set_patches(mesh, std::move(face_patch), std::move(patches));
}

void mark_patches(const Domain& domain, const SolverMesh& mesh, const std::vector<Vec3>& V, double h,
                  MarkedFaces& marked) {
  if (!domain.piecewise) return;
  std::vector<Triangle> faces;
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
    const std::array<int, 6> face = mesh.face(f);
    faces.push_back({face[0], face[1], face[2]});
  }
  marked.of_body = patches_by_position(domain, V, faces, h, until_interrupted());
}

MarkedFaces marked_faces(const SolverMesh& mesh, const MeshFile& file, const std::optional<SupportReport>& support) {
  return {faces_at_walls(mesh, file), faces_in_holes(mesh, file, support)};
}

void divide_boundary(SolverMesh& mesh, const MarkedFaces& marked, const OrientedPointCloud& cloud,
                     const Parameters& parameters, const Warn& warn, const std::vector<std::string>& names_of_file) {
  if (!marked.in_holes.empty()) {
    for (const auto& [label, name] : parse_label_names(parameters.output().label_names)) {
      if (lower_case(name) != kClosedHoles) continue;
      throw UsageError({Setting(kLabelNames, fmt::format("{}={}", label, name)),
                        ": this name is reserved for faces that no sample supports"});
    }
  }
  divide_but_holes(mesh, marked, cloud, parameters, names_of_file, warn);
  take_holes(mesh, marked.in_holes, warn);
}

}  // namespace umtet
