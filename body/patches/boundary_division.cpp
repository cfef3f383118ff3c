#include "body/patches/boundary_division.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "body/errors.h"
#include "common/formatted.h"
#include "mesh/patches/patch_curves.h"
#include "mesh/patches/patches.h"
#include "mesh/patches/planar_pieces.h"
#include "reconstruct/cloud/transfer/label_votes.h"

namespace umtet {
namespace {

// Number of samples with a wrong label that make an island: a majority of the voters. Islands smaller than their area
// are removed.
constexpr int kIslandSamples = kVoters / 2 + 1;
// Minimum area of a plane, in mean faces. It is about the number of faces around a vertex and its neighbours, the
// minimum that distinguishes flat from round: with fewer, single faces of a sphere would be planes.
constexpr double kLeastPlane = 20;
// Number of the first patch without labels. The body has the number 1.
constexpr int kFirstPatch = 2;

std::vector<int> distinct(std::vector<int> labels) {
  std::sort(labels.begin(), labels.end());
  labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
  return labels;
}

/// Returns the label of the patch of each face; 0: none. Empty without labels.
std::vector<int> labels_of_faces(const std::vector<int>& of_body, const std::vector<int>& labels) {
  if (labels.empty()) return {};
  std::vector<int> of_face(of_body.size(), 0);
  for (std::size_t f = 0; f < of_body.size(); ++f)
    if (of_body[f] >= 0) of_face[f] = labels[of_body[f]];
  return of_face;
}

/// Divides the boundary of one mesh.
class Division {
 public:
  Division(const std::vector<Vec3>& V, const std::vector<Triangle>& F, const std::vector<char>& at_wall)
      : V_(V), F_(F), at_wall_(at_wall) {}

  /// @param known  label of each face, where it is not 0; or empty
  BoundaryDivision by_labels(const OrientedPointCloud& cloud, const PatchOptions& options,
                             const std::vector<int>& known) const;
  /// Returns no patches if nothing is flat except walls.
  BoundaryDivision by_planes(double angle) const;
  BoundaryDivision by_angle(double angle) const;
  BoundaryDivision by_body(const std::vector<int>& of_body) const;
  BoundaryDivision whole() const { return {std::vector<int>(F_.size(), 0), {{kWholeBoundary, kFirstPatch}}, {}}; }

 private:
  bool is_wall(std::size_t f) const { return !at_wall_.empty() && at_wall_[f]; }
  bool has_walls() const { return std::find(at_wall_.begin(), at_wall_.end(), 1) != at_wall_.end(); }
  /// Returns for each of n pieces whether it has a face at a wall. @param piece  by face; -1: none
  std::vector<char> at_wall(const std::vector<int>& piece, int n) const;

  const std::vector<Vec3>& V_;
  const std::vector<Triangle>& F_;
  const std::vector<char>& at_wall_;
};

std::vector<char> Division::at_wall(const std::vector<int>& piece, int n) const {
  std::vector<char> walls(static_cast<std::size_t>(n), 0);
  for (std::size_t f = 0; f < piece.size(); ++f) {
    if (piece[f] >= 0 && is_wall(f)) walls[piece[f]] = 1;
  }
  return walls;
}

/// Returns the patches of labels in ascending order.
std::vector<MeshPart> label_patches(const std::vector<int>& labels, const std::map<int, std::string>& names) {
  long free = std::max(0, labels.back());
  std::vector<MeshPart> patches;
  for (const int label : labels) {
    const long number = label > 0 ? label : ++free;
    if (number >= std::numeric_limits<int>::max())
      throw UsageError("labels beyond 2147483646 cannot be numbers in files");
    patches.push_back({patch_name(label, names), static_cast<int>(number)});
  }
  return patches;
}

BoundaryDivision Division::by_labels(const OrientedPointCloud& cloud, const PatchOptions& options,
                                     const std::vector<int>& known) const {
  const FaceGeometry faces = face_geometry(V_, F_);
  std::vector<int> labels = vote_labels(cloud, faces.centroid, faces.normal);
  double least = options.label_min_area;
  if (least < 0) {
    double area = 0;
    for (std::size_t f = 0; f < faces.area.size(); ++f) area += is_wall(f) ? 0 : faces.area[f];
    least = kIslandSamples * area / static_cast<double>(cloud.points.size());
  }
  const auto take_known = [&] {
    for (std::size_t f = 0; f < known.size(); ++f) labels[f] = known[f] == 0 ? labels[f] : known[f];
  };
  take_known();
  absorb_islands(V_, F_, least, labels);
  take_known();
  std::vector<int> of_cloud;
  for (std::size_t f = 0; f < labels.size(); ++f) {
    if (!is_wall(f)) of_cloud.push_back(labels[f]);
  }
  const std::vector<int> left = distinct(std::move(of_cloud));
  BoundaryDivision division = whole();
  for (const int label : distinct_labels(cloud)) {
    if (std::binary_search(left.begin(), left.end(), label)) continue;
    division.notices.push_back(formatted("no boundary face has label %d (%s): too few samples for faces of this size",
                                         label, patch_name(label, options.names).c_str()));
  }
  if (left.empty()) return division;
  division.patches = label_patches(left, options.names);
  for (std::size_t f = 0; f < labels.size(); ++f) {
    const auto at = is_wall(f) ? left.end() : std::lower_bound(left.begin(), left.end(), labels[f]);
    division.face_patch[f] = static_cast<int>(at - left.begin());
  }
  if (has_walls()) {
    const auto by_number = [](const MeshPart& a, const MeshPart& b) { return a.number < b.number; };
    const std::vector<MeshPart>& patches = division.patches;
    const int number = std::max_element(patches.begin(), patches.end(), by_number)->number + 1;
    division.patches.push_back({kWalls, number});
  }
  return division;
}

BoundaryDivision Division::by_planes(double angle) const {
  const FaceGeometry faces = face_geometry(V_, F_);
  const double area = std::accumulate(faces.area.begin(), faces.area.end(), 0.);
  const double least = kLeastPlane * area / static_cast<double>(F_.size());
  BoundaryDivision division{planar_pieces(V_, F_, angle, least), {}, {}};
  std::vector<int>& plane = division.face_patch;
  const int n = *std::max_element(plane.begin(), plane.end()) + 1;
  const std::vector<char> walls = at_wall(plane, n);
  if (std::count(walls.begin(), walls.end(), 0) == 0) return {};
  int n_planes = 0, n_walls = 0;
  for (int p = 0; p < n; ++p) {
    division.patches.push_back(
        {walls[p] ? formatted("%s_%d", kWalls, ++n_walls) : formatted("plane_%d", ++n_planes), p + kFirstPatch});
  }
  if (std::find(plane.begin(), plane.end(), -1) != plane.end()) division.patches.push_back({"rest", n + kFirstPatch});
  for (int& p : plane) p = p < 0 ? n : p;
  return division;
}

BoundaryDivision Division::by_angle(double angle) const {
  std::vector<int> pieces = smooth_pieces(V_, F_, angle > 0 ? angle : 180);
  const int n = pieces.empty() ? 0 : *std::max_element(pieces.begin(), pieces.end()) + 1;
  if (n < 2) return whole();
  const std::vector<char> piece_at_wall = at_wall(pieces, n);
  const auto n_walls = std::count(piece_at_wall.begin(), piece_at_wall.end(), 1);
  std::vector<int> patch_of(static_cast<std::size_t>(n));
  std::vector<MeshPart> patches;
  for (const bool walls : {false, true}) {
    const char* const name = walls ? kWalls : angle > 0 ? "region" : kWholeBoundary;
    for (int p = 0, k = 1; p < n; ++p) {
      if ((piece_at_wall[p] != 0) != walls) continue;
      patch_of[p] = static_cast<int>(patches.size());
      patches.push_back({walls && n_walls == 1 ? name : formatted("%s_%d", name, k++), patch_of[p] + kFirstPatch});
    }
  }
  for (int& piece : pieces) piece = patch_of[piece];
  return {std::move(pieces), std::move(patches), {}};
}

BoundaryDivision Division::by_body(const std::vector<int>& of_body) const {
  const std::vector<int> all = distinct(of_body);
  BoundaryDivision division = whole();
  if (all.size() < 2) return division;
  division.patches.clear();
  for (const int p : all) {
    const int number = static_cast<int>(division.patches.size()) + kFirstPatch;
    division.patches.push_back({p < 0 ? "rest" : formatted("patch_%d", p + 1), number});
  }
  for (std::size_t f = 0; f < of_body.size(); ++f) {
    const auto at = std::lower_bound(all.begin(), all.end(), of_body[f]);
    division.face_patch[f] = static_cast<int>(at - all.begin());
  }
  division.curves = curves_between(F_, division.face_patch);
  return division;
}

/// Returns the least number that no patch has.
int body_number(const std::vector<MeshPart>& patches) {
  for (int number = 1;; ++number) {
    if (std::none_of(patches.begin(), patches.end(), [&](const MeshPart& p) { return p.number == number; }))
      return number;
  }
}

}  // namespace

std::vector<int> distinct_labels(const OrientedPointCloud& cloud) { return distinct(cloud.labels); }

std::string patch_name(int label, const std::map<int, std::string>& names) {
  const auto found = names.find(label);
  if (found != names.end()) return found->second;
  return label < 0 ? formatted("patch_m%ld", -static_cast<long>(label)) : formatted("patch_%d", label);
}

void require_patches(const OrientedPointCloud& cloud, const PatchOptions& options) {
  if (!(options.angle >= 0 && options.angle <= 180))
    throw std::invalid_argument("patches.angle: must be in [0, 180] degrees");
  if (!(options.planar >= 0 && options.planar < 90))
    throw std::invalid_argument("patches.planar: must be in [0, 90) degrees");
  if (!cloud.labels.empty()) label_patches(distinct_labels(cloud), options.names);
}

BoundaryDivision divide_boundary(const std::vector<Vec3>& V, const std::vector<Triangle>& F,
                                 const std::vector<char>& at_wall, const OrientedPointCloud& cloud,
                                 const PatchOptions& options, const std::vector<int>& of_body,
                                 const std::vector<int>& labels) {
  require_patches(cloud, options);
  const Division division(V, F, at_wall);
  if (!cloud.labels.empty()) return division.by_labels(cloud, options, labels_of_faces(of_body, labels));
  const auto without_planes = [&] {
    return options.angle > 0 || of_body.empty() ? division.by_angle(options.angle) : division.by_body(of_body);
  };
  if (!(options.planar > 0) || F.empty()) return without_planes();
  BoundaryDivision planes = division.by_planes(options.planar);
  if (!planes.patches.empty()) return planes;
  BoundaryDivision rest = without_planes();
  rest.notices.push_back("no part of the boundary is flat within " + shortest(options.planar) + " degrees");
  return rest;
}

void take_holes(const std::vector<char>& in_holes, BoundaryDivision& division) {
  if (std::find(in_holes.begin(), in_holes.end(), 1) == in_holes.end()) return;
  std::vector<int> n_left(division.patches.size(), 0);
  for (std::size_t f = 0; f < in_holes.size(); ++f) n_left[division.face_patch[f]] += in_holes[f] ? 0 : 1;
  int number = body_number(division.patches);
  std::vector<int> index(division.patches.size(), -1);
  std::vector<MeshPart> patches;
  for (std::size_t p = 0; p < division.patches.size(); ++p) {
    MeshPart part = division.patches[p];
    number = std::max(number, part.number);
    if (n_left[p] == 0) {
      division.notices.push_back(
          formatted("no boundary face is left in %s: all are in %s", part.name.c_str(), kClosedHoles));
      continue;
    }
    // If there are several patches, none has the name of all patches together.
    if (part.name == kWholeBoundary) part.name += "_1";
    index[p] = static_cast<int>(patches.size());
    patches.push_back(std::move(part));
  }
  patches.push_back({kClosedHoles, number + 1});
  for (std::size_t f = 0; f < division.face_patch.size(); ++f) {
    int& patch = division.face_patch[f];
    patch = in_holes[f] ? static_cast<int>(patches.size()) - 1 : index[patch];
  }
  division.patches = std::move(patches);
}

}  // namespace umtet
