#include "pipeline/boundary_patches.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <numeric>
#include <set>
#include <sstream>

#include "mesh/patches.h"
#include "mesh/planar_pieces.h"
#include "pipeline/exit_code.h"
#include "reconstruct/label_votes.h"

namespace umtet {
namespace {

// A piece that a majority of the voters can make is below the area that so many samples stand for.
constexpr double kIslandSamples = kVoters / 2 + 1;
// Mean faces. A vertex with all faces around it, and these with their neighbours, is the least that shows whether a
// part is flat or bends: with fewer, single faces of a sphere would be planes.
constexpr double kLeastPlane = 20;

std::string name_of(int label, const std::map<int, std::string>& names) {
  const auto found = names.find(label);
  if (found != names.end()) return found->second;
  return label < 0 ? fmt::format("patch_m{}", -static_cast<long>(label)) : fmt::format("patch_{}", label);
}

/// Patches of the labels that are there, in ascending order of the labels.
std::vector<MeshPart> label_patches(const std::vector<int>& labels, const std::map<int, std::string>& names) {
  long free = std::max(0, labels.back());
  std::vector<MeshPart> patches;
  for (const int label : labels) {
    const long number = label > 0 ? label : ++free;
    if (number >= std::numeric_limits<int>::max()) throw UsageError("labels beyond 2147483646 have no number in files");
    patches.push_back({name_of(label, names), static_cast<int>(number)});
  }
  return patches;
}

/// False when nothing is flat.
bool divide_by_planes(SolverMesh& mesh, double angle) {
  const FaceGeometry faces = face_geometry(mesh);
  const double area = std::accumulate(faces.area.begin(), faces.area.end(), 0.);
  const double least = kLeastPlane * area / static_cast<double>(mesh.n_faces());
  std::vector<int> plane = planar_pieces(mesh, angle, least);
  const int n = *std::max_element(plane.begin(), plane.end()) + 1;
  if (n == 0) return false;
  std::vector<MeshPart> patches;
  for (int p = 1; p <= n; ++p) patches.push_back({fmt::format("plane_{}", p), p + 1});
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

void divide_by_labels(SolverMesh& mesh, const OrientedPointCloud& cloud, const Parameters& parameters,
                      const Warn& warn) {
  const std::map<int, std::string> names = parse_label_names(parameters.text("output.label_names"));
  const std::vector<int> in_cloud = distinct(cloud.labels);
  for (const auto& [label, name] : names) {
    if (std::binary_search(in_cloud.begin(), in_cloud.end(), label)) continue;
    throw UsageError(fmt::format("--label-names {}={}: no point has that label; there are {}", label, name,
                                 fmt::join(in_cloud, ", ")));
  }
  const FaceGeometry faces = face_geometry(mesh);
  std::vector<int> labels = vote_labels(cloud, faces.centroid, faces.normal);
  double least = parameters.real("output.label_min_area");
  if (least < 0) {
    const double area = std::accumulate(faces.area.begin(), faces.area.end(), 0.);
    least = kIslandSamples * area / static_cast<double>(cloud.points.size());
  }
  absorb_islands(mesh, least, labels);
  const std::vector<int> left = distinct(labels);
  for (const int label : in_cloud) {
    if (std::binary_search(left.begin(), left.end(), label)) continue;
    warn(fmt::format("no boundary face has label {} ({}): too few samples for faces of this size", label,
                     name_of(label, names)));
  }
  if (left.empty()) return;
  for (int& label : labels) {
    label = static_cast<int>(std::lower_bound(left.begin(), left.end(), label) - left.begin());
  }
  set_patches(mesh, std::move(labels), label_patches(left, names));
}

}  // namespace

std::map<int, std::string> parse_label_names(const std::string& text) {
  std::map<int, std::string> names;
  std::set<std::string> taken = {"body", kWholeBoundary};
  std::istringstream items(text);
  for (std::string item; std::getline(items, item, ',');) {
    const auto refuse = [&](const std::string& what) {
      throw UsageError(fmt::format("--label-names '{}': {}; give LABEL=NAME,LABEL=NAME", item, what));
    };
    int label = 0;
    const std::size_t equals = std::min(item.find('='), item.size());
    const auto [end, error] = std::from_chars(item.data(), item.data() + equals, label);
    if (error != std::errc() || end != item.data() + equals || equals == item.size()) refuse("not LABEL=NAME");
    const std::string name = item.substr(equals + 1);
    if (const std::string problem = problem_of_name(name); !problem.empty()) refuse("the name " + problem);
    std::string lower = name;
    for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    if (!taken.insert(lower).second) refuse("that name is taken (case aside)");
    if (!names.emplace(label, name).second) refuse("that label has a name already");
  }
  return names;
}

void divide_boundary(SolverMesh& mesh, const OrientedPointCloud& cloud, const Parameters& parameters,
                     const Warn& warn) {
  if (!cloud.labels.empty()) return divide_by_labels(mesh, cloud, parameters, warn);
  if (!parameters.text("output.label_names").empty()) {
    throw UsageError(
        "--label-names: the points have no labels (PLY property label, PCD field label, or a last column)");
  }
  const double angle = parameters.real("output.patch_angle"), planar = parameters.real("output.patch_planar");
  if (planar > 0 && mesh.n_faces() > 0) {
    if (divide_by_planes(mesh, planar)) return;
    warn(fmt::format("no part of the boundary is flat within {} degrees", planar));
  }
  std::vector<int> pieces = smooth_pieces(mesh, angle > 0 ? angle : 180);
  const int n = pieces.empty() ? 0 : *std::max_element(pieces.begin(), pieces.end()) + 1;
  if (n < 2) return;
  std::vector<MeshPart> patches;
  for (int p = 1; p <= n; ++p) {
    // The body keeps the number 1 that it has without patches.
    patches.push_back({fmt::format("{}_{}", angle > 0 ? "region" : kWholeBoundary, p), p + 1});
  }
  set_patches(mesh, std::move(pieces), std::move(patches));
}

}  // namespace umtet
