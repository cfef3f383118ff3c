#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "mesh/background/background_mesh.h"
#include "mesh/octree/graded_mesh.h"

namespace umtet {

/// Reader with the results of BackgroundMesh::tet(), for many tets with nearby ids in any kind of background. In a
/// graded mesh it is several times as fast (OctreeTets::Reader). Use it in one thread.
class TetReader {
 public:
  explicit TetReader(const BackgroundMesh& background) : background_(background) {
    if (background.graded()) graded_.emplace(background.graded()->reader());
  }
  std::array<std::int64_t, 4> tet(std::int64_t tet) { return graded_ ? graded_->tet(tet) : background_.tet(tet); }

 private:
  const BackgroundMesh& background_;
  std::optional<GradedMesh::Reader> graded_;
};

}  // namespace umtet
