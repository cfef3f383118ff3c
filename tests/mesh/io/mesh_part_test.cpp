#include "mesh/io/mesh_part.h"

#include <gtest/gtest.h>

#include "tests/support/mesh_files.h"

namespace umtet {
namespace {

TEST(MeshPart, HasItsTetsTheirVerticesAndTheDataOfBoth) {
  const TetMesh mesh = test::sample().mesh;
  std::vector<std::int64_t> vertex_ids(mesh.V.size()), tet_ids(mesh.C.size());
  for (std::size_t v = 0; v < vertex_ids.size(); ++v) vertex_ids[v] = static_cast<std::int64_t>(100 + v);
  for (std::size_t t = 0; t < tet_ids.size(); ++t) tet_ids[t] = static_cast<std::int64_t>(1000 + t);
  const MeshFile whole = with_standard_data(mesh, vertex_ids, tet_ids);
  const std::vector<std::size_t> tets = {2, 3, 40};
  const MeshFile part = part_of(whole, tets);
  ASSERT_EQ(part.mesh.C.size(), tets.size());
  EXPECT_LT(part.mesh.V.size(), 13u);
  const auto& ids = std::get<std::vector<std::int64_t>>(part.point_data.at("background_vertex"));
  const auto& boundary = std::get<std::vector<std::uint8_t>>(part.point_data.at("boundary"));
  const auto& of_whole = std::get<std::vector<std::uint8_t>>(whole.point_data.at("boundary"));
  ASSERT_EQ(ids.size(), part.mesh.V.size());
  for (std::size_t v = 0; v < ids.size(); ++v) {
    const auto at = static_cast<std::size_t>(ids[v] - 100);
    EXPECT_EQ(part.mesh.V[v], mesh.V[at]);
    EXPECT_EQ(boundary[v], of_whole[at]);  // that of the whole mesh, not of the part
  }
  const auto& Q = std::get<std::vector<double>>(part.cell_data.at("mean_ratio"));
  for (std::size_t t = 0; t < tets.size(); ++t) {
    for (int k = 0; k < 4; ++k) EXPECT_EQ(ids[part.mesh.C[t][k]], 100 + mesh.C[tets[t]][k]);
    EXPECT_EQ(Q[t], std::get<std::vector<double>>(whole.cell_data.at("mean_ratio"))[tets[t]]);
  }
  EXPECT_EQ(std::get<std::vector<std::int64_t>>(part.cell_data.at("background_tet")),
            (std::vector<std::int64_t>{1002, 1003, 1040}));
}

}  // namespace
}  // namespace umtet
