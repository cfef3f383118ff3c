#include "mesh/background/explicit_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

#include "mesh/core/face_uses.h"
#include "mesh/core/orientation.h"

namespace umtet {

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
  on_boundary_.assign(mesh_.V.size(), false);
  std::vector<FaceUse> uses;
  for (int v = 0; v < static_cast<int>(mesh_.V.size()); ++v) {
    uses.clear();
    for (const int t : star(v)) add_faces(mesh_.C[t], static_cast<std::size_t>(t), v, uses);
    for_each_face(uses, [&](std::span<const FaceUse> face) {
      const FaceUse &one = face.front(), &other = face.back();
      if (face.size() == 1) {
        on_boundary_[v] = on_boundary_[one.low()] = on_boundary_[one.high()] = true;
      } else if (face.size() == 2 && one.reversed() != other.reversed()) {
        neighbor_[one.place()] = other.tet();
        neighbor_[other.place()] = one.tet();
      } else {
        throw std::invalid_argument("tets " + std::to_string(one.tet()) + " and " + std::to_string(other.tet()) +
                                    ": on one side of a face, or a third at it");
      }
    });
  }
}

void ExplicitMesh::find_links() {
  link_begin_.assign(1, 0);
  mean_edge_at_.resize(mesh_.V.size());
  double sum = 0;
  std::vector<int> link;
  for (int v = 0; v < static_cast<int>(mesh_.V.size()); ++v) {
    link.clear();
    for (const int t : star(v)) link.insert(link.end(), mesh_.C[t].begin(), mesh_.C[t].end());
    std::sort(link.begin(), link.end());
    link.erase(std::unique(link.begin(), link.end()), link.end());
    std::erase(link, v);
    double sum_at = 0;
    for (const int w : link) {
      const double length = (mesh_.V[w] - mesh_.V[v]).norm();
      sum += length;
      sum_at += length;
    }
    mean_edge_at_[v] = link.empty() ? 0 : sum_at / static_cast<double>(link.size());
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
