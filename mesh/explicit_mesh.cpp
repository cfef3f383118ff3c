#include "mesh/explicit_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "mesh/orientation.h"

namespace umtet {
namespace {

/// Place of the even rotation of a face that begins with its least vertex: two tets at a face see opposite ones.
Triangle rotated(Triangle face) {
  std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
  return face;
}

Triangle face_of(const Tet& tet, int k) {
  return rotated({tet[kTetFace[k][0]], tet[kTetFace[k][1]], tet[kTetFace[k][2]]});
}

}  // namespace

ExplicitMesh::ExplicitMesh(TetMesh mesh) : mesh_(std::move(mesh)) {
  check_tets();
  find_stars();
  find_neighbors();
  find_links();
}

void ExplicitMesh::check_tets() const {
  if (mesh_.C.empty()) throw std::invalid_argument("the mesh has no tets");
  const int n = static_cast<int>(mesh_.V.size());
  for (std::size_t t = 0; t < mesh_.C.size(); ++t) {
    const Tet& tet = mesh_.C[t];
    for (const int v : tet) {
      if (v < 0 || v >= n) throw std::invalid_argument("tet " + std::to_string(t) + ": no vertex " + std::to_string(v));
    }
    if (orientation_sign(mesh_.V[tet[0]], mesh_.V[tet[1]], mesh_.V[tet[2]], mesh_.V[tet[3]]) <= 0) {
      throw std::invalid_argument("tet " + std::to_string(t) + ": inverted or flat");
    }
  }
}

void ExplicitMesh::find_stars() {
  star_begin_.assign(mesh_.V.size() + 1, 0);
  for (const Tet& tet : mesh_.C) {
    for (const int v : tet) ++star_begin_[v + 1];
  }
  for (std::size_t v = 0; v < mesh_.V.size(); ++v) star_begin_[v + 1] += star_begin_[v];
  star_.resize(4 * mesh_.C.size());
  std::vector<std::size_t> next(star_begin_.begin(), star_begin_.end() - 1);
  for (int t = 0; t < static_cast<int>(mesh_.C.size()); ++t) {
    for (const int v : mesh_.C[t]) star_[next[v]++] = t;
  }
}

void ExplicitMesh::find_neighbors() {
  neighbor_.assign(4 * mesh_.C.size(), -1);
  on_rim_.assign(mesh_.V.size(), false);
  for (int t = 0; t < static_cast<int>(mesh_.C.size()); ++t) {
    for (int k = 0; k < 4; ++k) {
      const Triangle face = face_of(mesh_.C[t], k), seen_from_behind = rotated({face[0], face[2], face[1]});
      int& behind = neighbor_[4 * static_cast<std::size_t>(t) + k];
      for (const int other : star(face[0])) {
        for (int j = 0; other != t && j < 4; ++j) {
          const Triangle there = face_of(mesh_.C[other], j);
          if (there == face || (there == seen_from_behind && behind >= 0)) {
            throw std::invalid_argument("tets " + std::to_string(t) + " and " + std::to_string(other) +
                                        ": on one side of a face, or a third at it");
          }
          if (there == seen_from_behind) behind = other;
        }
      }
      if (behind >= 0) continue;
      for (const int v : face) on_rim_[v] = true;
    }
  }
}

void ExplicitMesh::find_links() {
  link_begin_.assign(1, 0);
  double sum = 0;
  std::vector<int> link;
  for (int v = 0; v < static_cast<int>(mesh_.V.size()); ++v) {
    link.clear();
    for (const int t : star(v)) link.insert(link.end(), mesh_.C[t].begin(), mesh_.C[t].end());
    std::sort(link.begin(), link.end());
    link.erase(std::unique(link.begin(), link.end()), link.end());
    std::erase(link, v);
    for (const int w : link) sum += (mesh_.V[w] - mesh_.V[v]).norm();
    link_.insert(link_.end(), link.begin(), link.end());
    link_begin_.push_back(link_.size());
  }
  mean_edge_ = sum / static_cast<double>(link_.size());
}

int ExplicitMesh::tet_near(const Vec3& x) const {
  Eigen::AlignedBox3d box;
  int best = -1;
  double least = std::numeric_limits<double>::infinity();
  for (int v = 0; v < static_cast<int>(mesh_.V.size()); ++v) {
    box.extend(mesh_.V[v]);
    const double d2 = (mesh_.V[v] - x).squaredNorm();
    if (d2 < least && !star(v).empty()) least = d2, best = star(v).front();
  }
  return box.contains(x) ? best : -1;
}

}  // namespace umtet
