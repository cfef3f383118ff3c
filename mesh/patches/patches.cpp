#include "mesh/patches/patches.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <stdexcept>
#include <utility>

#include "common/disjoint_sets.h"
#include "mesh/patches/detail/shared_edges.h"

namespace umtet {

using detail::shared_edges;
using detail::SharedEdge;

namespace {

/// Pieces of faces with one label, and the lengths of their borders.
class Islands {
 public:
  Islands(const std::vector<Vec3>& V, const std::vector<Triangle>& F, const std::vector<int>& labels);
  void absorb(double least);
  int label(std::size_t face) const {
    int p = piece_of_[face];
    while (merged_[p] >= 0) p = merged_[p];
    return pieces_[p].label;
  }

 private:
  struct Piece {
    int label = 0;
    double area = 0;
    std::map<int, double> border;  ///< by piece
  };
  int wanted_label(const Piece& piece) const;
  void merge(int from, int into);

  std::vector<Piece> pieces_;
  std::vector<int> piece_of_;  ///< by face
  std::vector<int> merged_;    ///< the piece a piece has gone into, or -1
};

Islands::Islands(const std::vector<Vec3>& V, const std::vector<Triangle>& F, const std::vector<int>& labels)
    : piece_of_(F.size(), -1) {
  const std::vector<SharedEdge> edges = shared_edges(F);
  DisjointSets joined(F.size());
  for (const SharedEdge& e : edges) {
    if (labels[e.face] == labels[e.other]) joined.unite(e.face, e.other);
  }
  const FaceGeometry faces = face_geometry(V, F);
  for (std::size_t f = 0; f < F.size(); ++f) {
    int& piece = piece_of_[joined.find(static_cast<int>(f))];
    if (piece < 0) {
      piece = static_cast<int>(pieces_.size());
      pieces_.push_back({labels[f], 0, {}});
    }
    piece_of_[f] = piece;
    pieces_[piece].area += faces.area[f];
  }
  for (const SharedEdge& e : edges) {
    const int p = piece_of_[e.face], q = piece_of_[e.other];
    if (p == q) continue;
    const double length = (V[e.v] - V[e.w]).norm();
    pieces_[p].border[q] += length;
    pieces_[q].border[p] += length;
  }
  merged_.assign(pieces_.size(), -1);
}

int Islands::wanted_label(const Piece& piece) const {
  std::map<int, double> length;
  for (const auto& [other, border] : piece.border) length[pieces_[other].label] += border;
  return std::max_element(length.begin(), length.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

void Islands::merge(int from, int into) {
  pieces_[into].area += pieces_[from].area;
  for (const auto& [other, length] : pieces_[from].border) {
    pieces_[other].border.erase(from);
    if (other == into) continue;
    pieces_[into].border[other] += length;
    pieces_[other].border[into] += length;
  }
  pieces_[from].border.clear();
  merged_[from] = into;
}

void Islands::absorb(double least) {
  std::set<std::pair<double, int>> small;
  const auto enter = [&](int p) {
    if (pieces_[p].area < least && !pieces_[p].border.empty()) small.emplace(pieces_[p].area, p);
  };
  for (std::size_t p = 0; p < pieces_.size(); ++p) enter(static_cast<int>(p));
  while (!small.empty()) {
    int island = small.begin()->second;
    small.erase(small.begin());
    const int label = wanted_label(pieces_[island]);
    std::vector<int> neighbours;
    for (const auto& [other, length] : pieces_[island].border) {
      if (pieces_[other].label == label) neighbours.push_back(other);
    }
    pieces_[island].label = label;
    for (const int other : neighbours) {
      small.erase({pieces_[other].area, other});
      merge(island, other);
      island = other;
    }
    enter(island);
  }
}

}  // namespace

FaceGeometry face_geometry(const std::vector<Vec3>& V, const std::vector<Triangle>& F) {
  FaceGeometry faces;
  for (const Triangle& face : F) {
    const Vec3 &a = V[face[0]], &b = V[face[1]], &c = V[face[2]];
    const Vec3 n = (b - a).cross(c - a);
    faces.centroid.push_back((a + b + c) / 3);
    faces.area.push_back(n.norm() / 2);
    faces.normal.push_back(n.stableNormalized());
  }
  return faces;
}

std::vector<int> smooth_pieces(const std::vector<Vec3>& V, const std::vector<Triangle>& F, double angle) {
  const FaceGeometry faces = face_geometry(V, F);
  // A little more than 180 degrees, where the cosine of rounding may fall.
  const double least_cosine = angle >= 180 ? -2 : std::cos(angle * std::numbers::pi / 180);
  DisjointSets joined(F.size());
  for (const SharedEdge& e : shared_edges(F)) {
    if (faces.normal[e.face].dot(faces.normal[e.other]) >= least_cosine) joined.unite(e.face, e.other);
  }
  std::vector<double> area(F.size(), 0);
  for (std::size_t f = 0; f < F.size(); ++f) area[joined.find(static_cast<int>(f))] += faces.area[f];
  std::vector<int> roots;
  for (std::size_t f = 0; f < F.size(); ++f) {
    if (joined.find(static_cast<int>(f)) == static_cast<int>(f)) roots.push_back(static_cast<int>(f));
  }
  std::stable_sort(roots.begin(), roots.end(), [&](int a, int b) { return area[a] > area[b]; });
  std::vector<int> number(F.size(), 0), piece(F.size());
  for (std::size_t i = 0; i < roots.size(); ++i) number[roots[i]] = static_cast<int>(i);
  for (std::size_t f = 0; f < F.size(); ++f) piece[f] = number[joined.find(static_cast<int>(f))];
  return piece;
}

void absorb_islands(const std::vector<Vec3>& V, const std::vector<Triangle>& F, double least,
                    std::vector<int>& labels) {
  if (labels.size() != F.size()) throw std::invalid_argument("absorb_islands: one label a face");
  Islands islands(V, F, labels);
  islands.absorb(least);
  for (std::size_t f = 0; f < labels.size(); ++f) labels[f] = islands.label(f);
}

}  // namespace umtet
