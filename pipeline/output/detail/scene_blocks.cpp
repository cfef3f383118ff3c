#include "pipeline/output/detail/scene_blocks.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "pipeline/output/report_page.h"

namespace umtet::detail {
namespace {

constexpr double kSteps16 = 65535, kSteps8 = 255;
constexpr std::uint8_t kUnknown = 255;

std::uint8_t rounded(double share, double steps) {
  return static_cast<std::uint8_t>(std::lround(steps * std::clamp(share, 0., 1.)));
}

}  // namespace

std::uint8_t in_steps(double value, double least, double most) {
  return most > least ? rounded((value - least) / (most - least), kSteps8) : 0;
}

std::uint8_t in_known_steps(double value, double least, double most) {
  if (std::isnan(value)) return kUnknown;
  return most > least ? rounded((value - least) / (most - least), kUnknown - 1) : 0;
}

std::string byte_block(const std::vector<std::uint8_t>& bytes) { return base64(bytes.data(), bytes.size()); }

std::string position_block(const std::vector<Vec3>& points, const Vec3& box_min, const Vec3& box_size) {
  std::vector<std::uint16_t> steps;
  steps.reserve(3 * points.size());
  const Vec3 scale = box_size.cwiseMax(1e-300).cwiseInverse();
  for (const Vec3& x : points) {
    for (int k = 0; k < 3; ++k) {
      const double share = std::clamp((x[k] - box_min[k]) * scale[k], 0., 1.);
      steps.push_back(static_cast<std::uint16_t>(std::lround(kSteps16 * share)));
    }
  }
  return base64(steps.data(), 2 * steps.size());
}

std::string direction_block(const std::vector<Vec3>& directions) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(3 * directions.size());
  for (const Vec3& n : directions)
    for (int k = 0; k < 3; ++k) bytes.push_back(in_known_steps(n[k], -1, 1));
  return byte_block(bytes);
}

int index_bytes_for(std::size_t n_vertices) { return n_vertices <= kSteps16 + 1 ? 2 : 4; }

std::string index_block(const std::vector<FacedTet>& list, int index_bytes) {
  if (index_bytes == 4) return base64(list.data(), sizeof(FacedTet) * list.size());
  std::vector<std::uint16_t> ids;
  ids.reserve(4 * list.size());
  for (const FacedTet& t : list)
    for (const int v : t) ids.push_back(static_cast<std::uint16_t>(v));
  return base64(ids.data(), 2 * ids.size());
}

std::vector<std::size_t> coarsen_faces(const std::vector<Vec3>& V, const Vec3& box_min, std::size_t most,
                                       std::vector<FacedTet>& faces) {
  double area = 0;
  for (const FacedTet& f : faces) area += (V[f[1]] - V[f[0]]).cross(V[f[2]] - V[f[0]]).norm() / 2;
  // About two triangles per square of the grid.
  double cell = std::sqrt(2 * area / static_cast<double>(most));
  for (std::vector<std::size_t> kept;; cell *= 1.1) {
    kept.clear();
    std::unordered_map<std::uint64_t, int> corner_of;
    std::vector<FacedTet> coarse = faces;
    for (std::size_t i = 0; i < coarse.size(); ++i) {
      FacedTet& f = coarse[i];
      for (int k = 0; k < 3; ++k) {
        const Eigen::Matrix<std::uint64_t, 3, 1> at =
            ((V[f[k]] - box_min) / cell).array().floor().matrix().cast<std::uint64_t>();
        f[k] = corner_of.try_emplace((at.z() << 42) + (at.y() << 21) + at.x(), f[k]).first->second;
      }
      if (f[0] != f[1] && f[1] != f[2] && f[2] != f[0]) kept.push_back(i);
    }
    if (kept.size() > most) continue;
    for (std::size_t k = 0; k < kept.size(); ++k) faces[k] = coarse[kept[k]];
    faces.resize(kept.size());
    return kept;
  }
}

}  // namespace umtet::detail
