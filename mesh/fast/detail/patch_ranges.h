#pragma once

#include <algorithm>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "mesh/background/background_mesh.h"
#include "mesh/background/vertex_links.h"

namespace umtet::detail {

/// How far what repair does for a tet may reach, seen from one of its vertices: what is done for two tets farther from
/// each other does not meet, and may be done at once.
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

  /// Keeps both by reference.
  /// @param reach  of RepairParams
  PatchRanges(const BackgroundMesh& background, const VertexLinks& links, int reach);

  /// Finds those of these vertices, by all threads. In lattices, where all reach equally far, there is nothing to find.
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
