#include "mesh/background/background_mesh.h"

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "mesh/octree/graded_mesh.h"

namespace umtet {
namespace {

// Ids stay far from overflow, and a mesh this size could not be walked anyway.
constexpr double kMaxTets = 1099511627776.0;  // 2^40

}  // namespace

BackgroundMesh::BackgroundMesh(const Tiling& tiling, const Box& box, double h)
    : is_lattice_(true),
      tiling_(tiling),
      tables_(tables(tiling)),
      h_(h),
      unit_(h / tiling.mean_edge),
      n_types_(static_cast<int>(tiling.points.size())),
      n_cell_tets_(static_cast<int>(tiling.tets.size())) {
  if (!(h > 0) || !std::isfinite(h)) throw std::invalid_argument("h = " + std::to_string(h) + ": must be > 0");
  if (box.isEmpty() || !box.sizes().allFinite()) throw std::invalid_argument("box: must be finite and not empty");
  const Eigen::Array3d period = Eigen::Array3d::Map(tiling_.period.data());
  const std::array<double, 3> pit = overhang(tiling_);
  const Eigen::Array3d n =
      (box.sizes().array() / (unit_ * period) + 2 * Eigen::Array3d::Map(pit.data()) / period).ceil().max(1);
  if (n.prod() * n_cell_tets_ > kMaxTets) {
    throw std::invalid_argument("h = " + std::to_string(h) + ": more than 2^40 tets in the box");
  }
  for (int a = 0; a < 3; ++a) n_[a] = static_cast<std::int64_t>(n[a]);
  origin_ = box.center() - (.5 * unit_ * n * period).matrix();
}

BackgroundMesh BackgroundMesh::part(const Cell& first, const Cell& n) const {
  if (!is_lattice_) throw std::invalid_argument("part: of a lattice only");
  BackgroundMesh made = *this;
  for (int a = 0; a < 3; ++a) {
    if (first[a] < 0 || n[a] < 1 || n[a] > n_[a] - first[a]) throw std::invalid_argument("part: cells out of range");
    made.first_[a] = first_[a] + first[a];
    made.n_[a] = n[a];
  }
  return made;
}

BackgroundMesh::BackgroundMesh(TetMesh mesh)
    : is_lattice_(false),
      explicit_(std::make_shared<const ExplicitMesh>(std::move(mesh))),
      h_(explicit_->mean_edge()),
      unit_(1),
      origin_(Vec3::Zero()),
      n_{},
      n_types_(0),
      n_cell_tets_(0) {}

BackgroundMesh::BackgroundMesh(GradedMesh mesh)
    : is_lattice_(false),
      graded_(std::make_shared<const GradedMesh>(std::move(mesh))),
      h_(graded_->finest()),
      unit_(1),
      origin_(Vec3::Zero()),
      n_{},
      n_types_(0),
      n_cell_tets_(0) {}

Box BackgroundMesh::box() const {
  if (graded_) return graded_->box();
  if (explicit_) {
    Box box;
    for (const Vec3& x : explicit_->mesh().V) box.extend(x);
    return box;
  }
  Vec3 low, size;
  for (int a = 0; a < 3; ++a) {
    low[a] = origin_[a] + unit_ * (static_cast<double>(first_[a]) * tiling_.period[a]);
    size[a] = unit_ * (static_cast<double>(n_[a]) * tiling_.period[a]);
  }
  return Box(low, low + size);
}

std::int64_t BackgroundMesh::n_vertices() const {
  if (!is_lattice_) return graded_ ? graded_->n_vertices() : static_cast<std::int64_t>(explicit_->mesh().V.size());
  return n_types_ * (n_[0] + 2) * (n_[1] + 2) * (n_[2] + 2);
}

std::int64_t BackgroundMesh::n_tets() const {
  if (!is_lattice_) return graded_ ? graded_->n_tets() : static_cast<std::int64_t>(explicit_->mesh().C.size());
  return n_cell_tets_ * n_[0] * n_[1] * n_[2];
}

BackgroundMesh::VertexAddress BackgroundMesh::vertex_address(std::int64_t vertex) const {
  const std::int64_t c = vertex / n_types_, row = c / (n_[0] + 2);
  return {static_cast<int>(vertex % n_types_), {c % (n_[0] + 2) - 1, row % (n_[1] + 2) - 1, row / (n_[1] + 2) - 1}};
}

std::int64_t BackgroundMesh::vertex_id(int type, const Cell& cell) const {
  return type + n_types_ * (cell[0] + 1 + (n_[0] + 2) * (cell[1] + 1 + (n_[1] + 2) * (cell[2] + 1)));
}

/// Off the walls: offsets of a tiling are in -1 .. 1, so that all tets at the cell's vertices are there.
bool BackgroundMesh::is_deep(const Cell& cell) const {
  return cell[0] > 0 && cell[1] > 0 && cell[2] > 0 && cell[0] + 1 < n_[0] && cell[1] + 1 < n_[1] && cell[2] + 1 < n_[2];
}

bool BackgroundMesh::holds(const Cell& cell, const std::array<int, 3>& offset) const {
  for (int a = 0; a < 3; ++a) {
    const std::int64_t c = cell[a] + offset[a];
    if (c < 0 || c >= n_[a]) return false;
  }
  return true;
}

std::int64_t BackgroundMesh::tet_id(int tet, const Cell& cell, const std::array<int, 3>& offset) const {
  return tet + n_cell_tets_ * (cell[0] + offset[0] + n_[0] * (cell[1] + offset[1] + n_[1] * (cell[2] + offset[2])));
}

Vec3 BackgroundMesh::position(std::int64_t vertex) const {
  if (!is_lattice_) return graded_ ? graded_->position(vertex) : explicit_->mesh().V[vertex];
  const VertexAddress v = vertex_address(vertex);
  const auto& p = tiling_.points[v.type];
  const auto& period = tiling_.period;
  // The numbers in brackets are exact for dyadic points and periods.
  return origin_ + unit_ * Vec3(static_cast<double>(v.cell[0] + first_[0]) * period[0] + p[0],
                                static_cast<double>(v.cell[1] + first_[1]) * period[1] + p[1],
                                static_cast<double>(v.cell[2] + first_[2]) * period[2] + p[2]);
}

std::array<std::int64_t, 4> BackgroundMesh::tet(std::int64_t tet) const {
  if (!is_lattice_) {
    if (graded_) return graded_->tet(tet);
    const Tet& corners = explicit_->mesh().C[tet];
    return {corners[0], corners[1], corners[2], corners[3]};
  }
  const std::int64_t c = tet / n_cell_tets_, row = c / n_[0];
  const Cell cell = {c % n_[0], row % n_[1], row / n_[1]};
  std::array<std::int64_t, 4> vertices;
  for (int k = 0; k < 4; ++k) {
    const auto& corner = tiling_.tets[tet % n_cell_tets_][k];
    vertices[k] =
        vertex_id(corner.type, {cell[0] + corner.offset[0], cell[1] + corner.offset[1], cell[2] + corner.offset[2]});
  }
  return vertices;
}

void BackgroundMesh::star(std::int64_t vertex, std::vector<std::int64_t>& tets) const {
  if (!is_lattice_) {
    if (graded_) return graded_->star(vertex, tets);
    const auto star = explicit_->star(static_cast<int>(vertex));
    tets.insert(tets.end(), star.begin(), star.end());
    return;
  }
  const VertexAddress v = vertex_address(vertex);
  for (const auto& [tet, offset] : tables_.star[v.type]) {
    if (holds(v.cell, offset)) tets.push_back(tet_id(tet, v.cell, offset));
  }
}

void BackgroundMesh::link(std::int64_t vertex, std::vector<std::int64_t>& vertices) const {
  if (!is_lattice_) {
    if (graded_) return graded_->link(vertex, vertices);
    const auto link = explicit_->link(static_cast<int>(vertex));
    vertices.insert(vertices.end(), link.begin(), link.end());
    return;
  }
  const VertexAddress v = vertex_address(vertex);
  const auto range_holds = [&](const Cell& c) {
    return c[0] >= -1 && c[0] <= n_[0] && c[1] >= -1 && c[1] <= n_[1] && c[2] >= -1 && c[2] <= n_[2];
  };
  const bool complete = !on_boundary(vertex);
  for (const auto& [type, offset] : tables_.link[v.type]) {
    const Cell c = {v.cell[0] + offset[0], v.cell[1] + offset[1], v.cell[2] + offset[2]};
    if (!complete) {
      // At the background boundary an edge of the tiling may have lost all its tets.
      if (!range_holds(c)) continue;
      const std::int64_t other = vertex_id(type, c);
      bool shares_tet = false;
      for (const auto& [t, tet_offset] : tables_.star[v.type]) {
        if (!holds(v.cell, tet_offset)) continue;
        for (const std::int64_t w : tet(tet_id(t, v.cell, tet_offset))) shares_tet |= w == other;
      }
      if (!shares_tet) continue;
    }
    vertices.push_back(vertex_id(type, c));
  }
}

bool BackgroundMesh::on_boundary(std::int64_t vertex) const {
  if (!is_lattice_) return graded_ ? graded_->on_boundary(vertex) : explicit_->on_boundary(static_cast<int>(vertex));
  const VertexAddress v = vertex_address(vertex);
  if (is_deep(v.cell)) return false;
  for (const auto& corner : tables_.star[v.type]) {
    if (!holds(v.cell, corner.offset)) return true;
  }
  return false;
}

bool BackgroundMesh::is_off_boundary(std::int64_t first, std::int64_t last) const {
  if (!is_lattice_) return false;
  const Cell a = cell(first), b = cell(last);
  return is_deep(a) && is_deep(b) && a[1] == b[1] && a[2] == b[2];
}

bool BackgroundMesh::has_tets(std::int64_t vertex) const {
  if (!is_lattice_) return graded_ || !explicit_->star(static_cast<int>(vertex)).empty();
  const VertexAddress v = vertex_address(vertex);
  if (is_deep(v.cell)) return true;
  for (const auto& corner : tables_.star[v.type]) {
    if (holds(v.cell, corner.offset)) return true;
  }
  return false;
}

std::int64_t BackgroundMesh::neighbor(std::int64_t tet, int face) const {
  if (!is_lattice_) return graded_ ? graded_->neighbor(tet, face) : explicit_->neighbor(static_cast<int>(tet), face);
  const std::int64_t c = tet / n_cell_tets_, row = c / n_[0];
  const Cell cell = {c % n_[0], row % n_[1], row / n_[1]};
  const auto& next = tables_.neighbor[tet % n_cell_tets_][face];
  return holds(cell, next.offset) ? tet_id(next.tet, cell, next.offset) : -1;
}

std::int64_t BackgroundMesh::tet_near(const Vec3& x) const {
  if (!is_lattice_) return graded_ ? graded_->tet_at(x) : explicit_->tet_near(x);
  Cell cell;
  for (int a = 0; a < 3; ++a) {
    const double c = std::floor((x[a] - origin_[a]) / (unit_ * tiling_.period[a])) - static_cast<double>(first_[a]);
    if (!(c >= 0 && c < static_cast<double>(n_[a]))) return -1;
    cell[a] = static_cast<std::int64_t>(c);
  }
  return tet_id(0, cell, {0, 0, 0});
}

std::int64_t BackgroundMesh::key_of_vertex(std::int64_t vertex) const {
  return graded_ ? static_cast<std::int64_t>(graded_->key(vertex)) : vertex;
}

std::int64_t BackgroundMesh::vertex_of_key(std::int64_t key) const {
  if (graded_) return graded_->vertex_of(static_cast<std::uint64_t>(key));
  return key >= 0 && key < n_vertices() ? key : -1;
}

bool BackgroundMesh::bcc_link(std::int64_t vertex, BccLink& vertices) const {
  return graded_ && graded_->bcc_link(vertex, vertices);
}

double BackgroundMesh::mean_edge(std::int64_t vertex) const {
  return graded_ ? graded_->mean_edge(vertex) : explicit_->mean_edge(static_cast<int>(vertex));
}

}  // namespace umtet
