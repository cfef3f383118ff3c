#pragma once

#include <algorithm>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "mesh/background/background_mesh.h"
#include "mesh/background/vertex_links.h"

namespace umtet::detail {

/// Bounds on the region that the repair of a tet may change, seen from one of its vertices. Repairs of two tets whose
/// ranges do not meet are independent and can run at once.
class PatchRanges {
 public:
  struct Range {
    Vec3 at;
    double far;  ///< model units
    bool meets(const Range& other) const { return (other.at - at).norm() <= .5 * (other.far + far); }
    bool meets_any(const std::vector<Range>& others) const {
      return std::any_of(others.begin(), others.end(), [&](const Range& other) { return meets(other); });
    }
  };

  /// Keeps references.
  /// @param reach  RepairParams::reach
  PatchRanges(const BackgroundMesh& background, const VertexLinks& links, int reach);

  /// Computes the ranges of these vertices, by all threads. In lattices all ranges are equal, and nothing is computed.
  void find(const std::vector<std::int64_t>& vertices);
  Range of(std::int64_t vertex);

 private:
  Range found(std::int64_t vertex) const;

  const BackgroundMesh& background_;
  const VertexLinks& links_;
  int reach_;
  double far_of_lattice_ = 0;
  std::unordered_map<std::int64_t, Range> known_;
};

}  // namespace umtet::detail
