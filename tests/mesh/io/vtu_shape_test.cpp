#include "mesh/io/vtu_shape.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include "mesh/background/background_mesh.h"
#include "mesh/io/tet_mesh_io.h"
#include "mesh/submesh/submesh.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

template <class T>
std::string text_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

TEST(VtuShape, SaysWhereWriteVtuPutsEverything) {
  const auto sphere = testing::sphere();
  const Submesh submesh = find_submesh({a15(), Box(Vec3::Constant(-1.6), Vec3::Constant(1.6)), .5}, sphere);
  MeshFile mesh = with_standard_data(submesh.mesh, submesh.background_vertex, submesh.background_tet);
  mesh.point_data["place"] = mesh.mesh.V;
  std::vector<double> places, quality = std::get<std::vector<double>>(mesh.cell_data.at("mean_ratio"));
  for (const Vec3& x : mesh.mesh.V) places.insert(places.end(), x.data(), x.data() + 3);
  std::vector<std::int32_t> corners, ends;
  for (const Tet& t : mesh.mesh.C) {
    corners.insert(corners.end(), t.begin(), t.end());
    ends.push_back(static_cast<std::int32_t>(corners.size()));
  }
  const std::map<std::string, std::string> arrays = {
      {"background_vertex", text_of(submesh.background_vertex)},
      {"boundary", text_of(std::get<std::vector<std::uint8_t>>(mesh.point_data.at("boundary")))},
      {"background_tet", text_of(submesh.background_tet)},
      {"mean_ratio", text_of(quality)},
      {"Points", text_of(places)},
      {"place", text_of(places)},
      {"connectivity", text_of(corners)},
      {"offsets", text_of(ends)},
      {"types", text_of(std::vector<std::uint8_t>(ends.size(), 10))}};
  const VtuShape shape =
      vtu_shape(mesh.mesh.V.size(), mesh.mesh.C.size(),
                {{"background_vertex", VtuField::Type::Int64},
                 {"boundary", VtuField::Type::UInt8},
                 {"place", VtuField::Type::ThreeFloat64}},
                {{"background_tet", VtuField::Type::Int64}, {"mean_ratio", VtuField::Type::Float64}});
  EXPECT_FALSE(shape.has_wide_ids);
  std::string made(shape.texts.back().first + shape.texts.back().second.size(), ' ');
  for (const auto& [at, text] : shape.texts) made.replace(at, text.size(), text);
  for (const VtuShape::Array& a : shape.arrays) {
    const std::string& text = arrays.at(a.name);
    ASSERT_EQ(text.size(), a.n_bytes) << a.name;
    made.replace(a.begin, text.size(), text);
  }
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "umtet_vtu_shape.vtu";
  write_vtu(file, mesh);
  std::ifstream in(file, std::ios::binary);
  EXPECT_TRUE(made == std::string(std::istreambuf_iterator<char>(in), {}));
  std::filesystem::remove(file);
}

TEST(VtuShape, IdsBeyondTwoToThe31AreWide) {
  const std::size_t n = 10'000'000'000;
  const VtuShape shape = vtu_shape(n / 5, n, {}, {{"mean_ratio", VtuField::Type::Float64}});
  EXPECT_TRUE(shape.has_wide_ids);
  EXPECT_EQ(shape.arrays[2].name, "connectivity");
  EXPECT_EQ(shape.arrays[2].n_bytes, 32 * n);
  EXPECT_GT(shape.arrays[1].begin, 32 * n);
}

}  // namespace
}  // namespace umtet
