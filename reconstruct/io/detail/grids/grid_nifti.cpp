// NIfTI-1: a head of 348 bytes (nifti1.h), then the voxels at vox_offset.
#include <fmt/format.h>

#include <Eigen/Geometry>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "reconstruct/io/detail/grids/grid_source.h"

namespace umtet::detail {
namespace {

constexpr std::size_t kHeadBytes = 348;

class NiftiHead {
 public:
  NiftiHead(std::string bytes, bool swap) : bytes_(std::move(bytes)), swap_(swap) {}
  double number(std::size_t at, NumberType::Kind kind, int size) const {
    std::vector<double> one;
    append_numbers(std::string_view(bytes_).substr(at, static_cast<std::size_t>(size)), {kind, size}, swap_, one);
    return one.front();
  }
  int whole(std::size_t at) const { return static_cast<int>(number(at, NumberType::Kind::Signed, 2)); }
  double real(std::size_t at) const { return number(at, NumberType::Kind::Float, 4); }
  std::string_view text(std::size_t at, std::size_t n) const { return std::string_view(bytes_).substr(at, n); }

 private:
  std::string bytes_;
  bool swap_;
};

std::optional<NumberType> type_of_code(int code) {
  using Kind = NumberType::Kind;
  switch (code) {
    case 2:
      return NumberType{Kind::Unsigned, 1};
    case 4:
      return NumberType{Kind::Signed, 2};
    case 8:
      return NumberType{Kind::Signed, 4};
    case 16:
      return NumberType{Kind::Float, 4};
    case 64:
      return NumberType{Kind::Float, 8};
    case 256:
      return NumberType{Kind::Signed, 1};
    case 512:
      return NumberType{Kind::Unsigned, 2};
    case 768:
      return NumberType{Kind::Unsigned, 4};
    case 1024:
      return NumberType{Kind::Signed, 8};
    case 1280:
      return NumberType{Kind::Unsigned, 8};
    default:
      return std::nullopt;
  }
}

/// The sform, else the qform, else the voxel sizes, as nifti1.h has them.
void read_place(const NiftiHead& head, Grid& grid) {
  constexpr std::size_t kPixdim = 76, kQform = 252, kSform = 254, kQuaternion = 256, kOffset = 268, kRows = 280;
  Vec3 steps;
  for (int k = 0; k < 3; ++k) steps[k] = std::abs(head.real(kPixdim + 4 * (1 + static_cast<std::size_t>(k))));
  if (head.whole(kSform) > 0) {
    for (int row = 0; row < 3; ++row) {
      const std::size_t at = kRows + 16 * static_cast<std::size_t>(row);
      for (int k = 0; k < 3; ++k) grid.axes(row, k) = head.real(at + 4 * static_cast<std::size_t>(k));
      grid.origin[row] = head.real(at + 12);
    }
    return;
  }
  grid.axes = steps.asDiagonal();
  if (head.whole(kQform) <= 0) return;
  const Vec3 v(head.real(kQuaternion), head.real(kQuaternion + 4), head.real(kQuaternion + 8));
  const double w = std::sqrt(std::max(0., 1 - v.squaredNorm()));
  if (head.real(kPixdim) < 0) grid.axes.col(2) *= -1;
  grid.axes = Eigen::Quaterniond(w, v.x(), v.y(), v.z()).normalized().toRotationMatrix() * grid.axes;
  for (int k = 0; k < 3; ++k) grid.origin[k] = head.real(kOffset + 4 * static_cast<std::size_t>(k));
}

}  // namespace

Grid read_nifti(GridSource& source) {
  const std::string bytes = source.take(kHeadBytes);
  std::int32_t size = 0;
  std::memcpy(&size, bytes.data(), sizeof size);
  const bool swap = size != static_cast<std::int32_t>(kHeadBytes);
  const NiftiHead head(bytes, swap);
  constexpr std::size_t kDim = 40, kDatatype = 70, kVoxOffset = 108, kSlope = 112, kMagic = 344;
  if (head.text(kMagic, 4) == std::string_view("ni1\0", 4)) {
    source.refuse("the voxels are in another file (.hdr and .img): save it as one file, .nii");
  }
  const int n_dims = head.whole(kDim);
  if (n_dims < 3 || n_dims > 7) source.refuse(fmt::format("{} dimensions: three are wanted", n_dims));
  std::vector<std::int64_t> n;
  for (int k = 1; k <= n_dims; ++k) {
    const int count = head.whole(kDim + 2 * static_cast<std::size_t>(k));
    if (k > 3 && count != 1) source.refuse("more than one number a voxel: three dimensions are wanted");
    if (k <= 3) n.push_back(count);
  }
  const std::optional<NumberType> type = type_of_code(head.whole(kDatatype));
  if (!type) source.refuse(fmt::format("data type {} is none of one real number a voxel", head.whole(kDatatype)));
  source.require_nodes(n, type->bytes);
  const double offset = head.real(kVoxOffset);
  if (!(offset >= kHeadBytes && offset < 1e9)) source.refuse("vox_offset is not behind the head");
  source.take(static_cast<std::uint64_t>(offset) - kHeadBytes);
  Grid grid;
  grid.n = {static_cast<int>(n[0]), static_cast<int>(n[1]), static_cast<int>(n[2])};
  read_place(head, grid);
  grid.values = source.take_numbers(grid.size(), *type, swap);
  const double slope = head.real(kSlope), intercept = head.real(kSlope + 4);
  const bool scales = slope != 0 && std::isfinite(slope) && std::isfinite(intercept) && !(slope == 1 && intercept == 0);
  grid.is_whole = type->kind != NumberType::Kind::Float && !scales;
  if (scales) {
    for (double& v : grid.values) v = slope * v + intercept;
  }
  return grid;
}

}  // namespace umtet::detail
