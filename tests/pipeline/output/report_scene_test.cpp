// What a report is put together from.

#include "pipeline/output/report_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include "mesh/patches/patches.h"
#include "pipeline/domain/load_domain.h"
#include "pipeline/output/report_page.h"
#include "pipeline/output/report_plot.h"
#include "tests/support/box_tets.h"

namespace umtet {
namespace {

MeshFile cube(int n) { return with_standard_data(testing::box_tets({0, 0, 0}, {1, 1, 1}, {n, n, n}), {}, {}); }

Domain cube_domain() {
  Parameters parameters;
  parameters.set("mesh.implicit=x^2-1");
  parameters.set("mesh.box=-2,-2,-2,2,2,2");
  return formula_domain(parameters);
}

std::vector<std::uint8_t> decoded(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  unsigned n = 0, bits = 0;
  for (const char c : text.substr(0, text.find('='))) {
    n = (n << 6) | static_cast<unsigned>(digits.find(c));
    bits += 6;
    if (bits >= 8) bytes.push_back(static_cast<std::uint8_t>(n >> (bits -= 8)));
  }
  return bytes;
}

std::vector<unsigned> words(const ReportScene& scene, const std::string& name) {
  std::vector<unsigned> out;
  for (const auto& [block, text] : scene.blocks) {
    if (block != name) continue;
    const std::vector<std::uint8_t> b = decoded(text);
    for (std::size_t i = 0; i + 1 < b.size(); i += 2) out.push_back(b[i] + 256u * b[i + 1]);
  }
  return out;
}

TEST(Base64, IsThatOfTheRfc) {
  EXPECT_EQ(base64("", 0), "");
  EXPECT_EQ(base64("f", 1), "Zg==");
  EXPECT_EQ(base64("fo", 2), "Zm8=");
  EXPECT_EQ(base64("foo", 3), "Zm9v");
  EXPECT_EQ(base64("\xff\xfe\xfd", 3), "//79");
}

/// The six sides of the cube as patches.
SolverMesh sides(const MeshFile& mesh) {
  SolverMesh m = solver_mesh(mesh.mesh);
  std::vector<MeshPart> patches;
  for (int p = 1; p <= 6; ++p) patches.push_back({"side_" + std::to_string(p), 10 * p});
  set_patches(m, smooth_pieces(m.nodes, m.triangles(), 45), patches);
  return m;
}

TEST(ReportScene, HoldsTheWholeMesh) {
  const MeshFile mesh = cube(3);
  const ReportScene scene = report_scene(mesh, cube_domain(), sides(mesh));
  EXPECT_EQ(scene.head.n_faces_shown, 108u);
  EXPECT_EQ(scene.head.n_tets_shown, 162u);
  EXPECT_FALSE(scene.head.planes.has_value());
  const std::vector<unsigned> x = words(scene, "positions"), faces = words(scene, "faces"), tets = words(scene, "tets");
  ASSERT_EQ(x.size(), 3 * mesh.mesh.V.size());
  const auto at = [&](unsigned v) -> Vec3 { return Vec3(x[3 * v], x[3 * v + 1], x[3 * v + 2]) / 65535; };
  double volume = 0, surface_volume = 0;
  for (std::size_t t = 0; t < tets.size(); t += 4) {
    const Vec3 a = at(tets[t]);
    volume += (at(tets[t + 1]) - a).cross(at(tets[t + 2]) - a).dot(at(tets[t + 3]) - a) / 6;
  }
  for (std::size_t f = 0; f < faces.size(); f += 4) {
    const Vec3 a = at(faces[f]), b = at(faces[f + 1]), c = at(faces[f + 2]);
    surface_volume += a.cross(b).dot(c) / 6;
    EXPECT_LT((b - a).cross(c - a).dot(at(faces[f + 3]) - a), 0) << "the fourth vertex is behind the face";
  }
  EXPECT_NEAR(volume, 1, 1e-4);
  EXPECT_NEAR(surface_volume, 1, 1e-4);
  // |psi| / |grad psi| of x^2 - 1 is largest at the centres of faces nearest to x = 0, and they are on it.
  EXPECT_GT(scene.head.deviation.most, 1);
}

TEST(ReportScene, FacesHaveTheirPatches) {
  const MeshFile mesh = cube(9);
  ReportCaps caps;
  for (const std::size_t most : {972, 300}) {  // the whole surface, and a coarsened one
    caps.faces = most;
    const ReportScene scene = report_scene(mesh, cube_domain(), sides(mesh), caps);
    const std::vector<SceneHead::Patch>& patches = scene.head.patches;
    ASSERT_EQ(patches.size(), 6u);
    for (int p = 0; p < 6; ++p) {
      EXPECT_EQ(patches[p].name, "side_" + std::to_string(p + 1));
      EXPECT_EQ(patches[p].number, 10 * (p + 1));
      EXPECT_EQ(patches[p].n_faces, 162u);
      EXPECT_NEAR(patches[p].area, 1, 1e-12);
    }
    const std::vector<unsigned> x = words(scene, "positions"), faces = words(scene, "faces"),
                                pairs = words(scene, "face_patch");
    ASSERT_EQ(pairs.size(), faces.size() / 8);
    const std::vector<int> expected = sides(mesh).face_patch;
    std::map<unsigned, std::set<int>> of_side;  // patches of the faces whose corners are on a side, by axis and end
    for (std::size_t f = 0; f < 2 * pairs.size(); ++f) {
      const int patch = static_cast<int>(f % 2 == 0 ? pairs[f / 2] & 255 : pairs[f / 2] >> 8);
      EXPECT_TRUE(most < 972 || patch == expected[f]) << f;
      for (unsigned axis = 0; axis < 3; ++axis) {
        const auto at = [&](int k) { return x[3 * faces[4 * f + k] + axis]; };
        if (at(0) == at(1) && at(1) == at(2) && at(0) % 65535 == 0) of_side[2 * axis + at(0) / 65535].insert(patch);
      }
    }
    ASSERT_EQ(of_side.size(), 6u);
    std::set<int> all;
    for (const auto& [side, found] : of_side) {
      EXPECT_TRUE(most < 972 || found.size() == 1) << side;
      all.insert(found.begin(), found.end());
    }
    EXPECT_EQ(all.size(), 6u);
  }
}

TEST(ReportScene, WhatSamplesCarryHasAByteForNoValue) {
  MeshFile mesh = cube(3);
  const std::size_t n = mesh.mesh.V.size();
  std::vector<double> heat(n, std::nan("")), none = heat;
  std::vector<Vec3> rgb(n, Vec3::Constant(std::nan("")));
  for (std::size_t v = 0; v < n; ++v) {
    const double x = mesh.mesh.V[v].x();
    if (x < .1 || x > .9) heat[v] = 20 + 10 * std::round(x);
    if (x < .1) rgb[v] = Vec3(0, .5, 1);
  }
  mesh.point_data["scan_heat"] = heat;
  mesh.point_data["scan_none"] = none;
  mesh.point_data["scan_rgb"] = rgb;
  mesh.point_data["heat"] = heat;  // not of the scan
  const ReportScene scene = report_scene(mesh, cube_domain(), sides(mesh));
  ASSERT_EQ(scene.head.fields.size(), 2u);
  EXPECT_EQ(scene.head.fields[0].name, "scan_heat");
  EXPECT_EQ(scene.head.fields[0].range.least, 20);
  EXPECT_EQ(scene.head.fields[0].range.most, 30);
  EXPECT_TRUE(scene.head.fields[1].of_colours);
  std::map<std::string, std::vector<std::uint8_t>> blocks;
  for (const auto& [name, text] : scene.blocks) blocks[name] = decoded(text);
  const std::vector<unsigned> places = words(scene, "positions");
  ASSERT_EQ(blocks.at("vertex_field_0").size(), places.size() / 3);
  ASSERT_EQ(blocks.at("vertex_field_1").size(), places.size());
  for (std::size_t v = 0; v < places.size() / 3; ++v) {
    const unsigned x = places[3 * v];
    EXPECT_EQ(blocks["vertex_field_0"][v], x == 0 ? 0 : x == 65535 ? 254 : 255);
    const std::vector<int> colour(blocks["vertex_field_1"].begin() + 3 * v,
                                  blocks["vertex_field_1"].begin() + 3 * v + 3);
    EXPECT_EQ(colour, x == 0 ? (std::vector<int>{0, 127, 254}) : (std::vector<int>{255, 255, 255}));
  }
}

TEST(ReportScene, OfALargeMeshThereIsTheWorstAndTheMiddle) {
  MeshFile mesh = cube(9);
  auto& q = std::get<std::vector<double>>(mesh.cell_data.at("mean_ratio"));
  q[77] = .1;
  q[33] = .2;
  ReportCaps caps;
  caps.faces = 300;
  caps.tets = 3000;
  caps.worst = 2;
  const ReportScene scene = report_scene(mesh, cube_domain(), sides(mesh), caps);
  EXPECT_EQ(scene.head.n_faces, 972u);
  EXPECT_LE(scene.head.n_faces_shown, 300u);
  EXPECT_GT(scene.head.n_faces_shown, 100u);
  EXPECT_EQ(scene.head.n_tets, 4374u);
  EXPECT_LE(scene.head.n_tets_shown, 3000u);
  ASSERT_TRUE(scene.head.planes.has_value());
  EXPECT_FALSE(scene.head.planes->empty());
  const std::vector<unsigned> q8 = words(scene, "tet_quality");  // two bytes a word, the first is the low one
  ASSERT_FALSE(q8.empty());
  EXPECT_EQ(q8[0] & 255, 0);
  EXPECT_GT(q8[0] >> 8, 0);
  EXPECT_LT(q8[0] >> 8, q8[1] & 255);
}

TEST(LinePlot, PlacesPointsOnALogarithmicAxis) {
  const std::string svg = line_plot({"t", "x", "y", true, false}, {{"", "c0", {{1, 0}, {10, .5}, {100, 1}, {0, .7}}}});
  const std::size_t from = svg.find("points=\"") + 8;
  std::istringstream points(svg.substr(from, svg.find('"', from) - from));
  double x[3], y[3];
  char comma;
  for (int k = 0; k < 3; ++k) points >> x[k] >> comma >> y[k];
  ASSERT_TRUE(points);
  EXPECT_NEAR(x[1] - x[0], x[2] - x[1], .11);
  EXPECT_NEAR(y[1], (y[0] + y[2]) / 2, .11);
  EXPECT_LT(y[2], y[0]);
  double more;
  EXPECT_FALSE(points >> more) << "0 has no place on a logarithmic axis";
}

TEST(ReportPage, UsersTextsAreNoMarkup) {
  EXPECT_EQ(html_text("<a & \"b\">"), "&lt;a &amp; &quot;b&quot;&gt;");
  const Json json = {{"k", "</script>"}};
  EXPECT_EQ(script_json(json).find('<'), std::string::npos);
  EXPECT_EQ(Json::parse(script_json(json)), json);
  EXPECT_EQ(filled("a{{b}}c{{d}}", {{"b", "{{d}}"}, {"d", "2"}}), "a{{d}}c2");
  EXPECT_THROW(filled("{{e}}", {}), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
