#include "mesh/regions/detail/periodic_cells.h"

namespace umtet::detail {
namespace {

/// The periods from the first cell of a range to a cell, and the cell within the range.
std::int64_t periods_to(std::int64_t cell, std::int64_t n, std::int64_t& within) {
  const std::int64_t from_first = cell - PeriodicCells::kLayers;
  const std::int64_t periods = from_first >= 0 ? from_first / n : -((n - 1 - from_first) / n);
  within = cell - periods * n;
  return periods;
}

}  // namespace

std::int64_t PeriodicCells::representative(std::int64_t v) const {
  BackgroundMesh::Cell cell = lattice_->cell(v);
  for (int a = 0; a < 3; ++a) periods_to(cell[a], n_[a], cell[a]);
  return lattice_->vertex_id(lattice_->type(v), cell);
}

std::array<int, 3> PeriodicCells::copy(std::int64_t v) const {
  const BackgroundMesh::Cell cell = lattice_->cell(v);
  std::array<int, 3> periods{};
  std::int64_t within = 0;
  for (int a = 0; a < 3; ++a) periods[a] = static_cast<int>(periods_to(cell[a], n_[a], within));
  return periods;
}

}  // namespace umtet::detail
