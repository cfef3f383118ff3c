#include "reconstruct/triangles/feature_lines.h"

#include <gtest/gtest.h>

#include "reconstruct/triangles/sharp_edges.h"
#include "tests/reconstruct/triangles/solids.h"

namespace umtet {
namespace {

/// One polyline. \param closes  its last point is joined to the first
FeatureLines polyline(const std::vector<Vec3>& points, bool closes = false) {
  FeatureLines lines{points, {}};
  for (int k = 0; k + 1 < static_cast<int>(points.size()); ++k) lines.segments.push_back({k, k + 1});
  if (closes) lines.segments.push_back({static_cast<int>(points.size()) - 1, 0});
  return lines;
}

/// The square of cube_with_imprint().
FeatureLines square() { return polyline({Vec3(.3, .3, 1), Vec3(.7, .3, 1), Vec3(.7, .7, 1), Vec3(.3, .7, 1)}, true); }

TEST(FeatureLines, LinesAlongEdgesAreTheseEdges) {
  const FollowedLines found = follow_lines(test::cube_with_imprint(), square());
  EXPECT_FALSE(found.fault);
  EXPECT_EQ(found.n_edges, 4u);
  const std::vector<std::array<int, 2>> wanted = {{8, 9}, {8, 11}, {9, 10}, {10, 11}};
  EXPECT_EQ(found.lines, wanted);
}

TEST(FeatureLines, TrianglesWithCornersOfTheirOwnHaveTheLinesOnBothSides) {
  for (const double off : {0., 1e-9}) {
    TriangleMesh soup = test::split(test::cube_with_imprint(), off);
    FollowedLines found = follow_lines(soup, square());
    EXPECT_FALSE(found.fault);
    EXPECT_EQ(found.n_edges, 4u);
    EXPECT_EQ(found.lines.size(), 8u);
    soup.lines = std::move(found.lines);
    const SharpEdges edges = find_sharp_edges(soup);
    EXPECT_EQ(edges.n_curves_by(SharpCurve::Reason::Line), 4u);
    EXPECT_EQ(edges.n_patches, 7u);
  }
}

TEST(FeatureLines, EitherMayHaveMorePoints) {
  // One segment over both halves of an edge, and three segments along one edge.
  TriangleMesh mesh = test::cube();
  const int middle = static_cast<int>(mesh.V.size());
  mesh.V.emplace_back(.5, 0, 0);  // of the edge from 0 to 4
  std::vector<Triangle> halves;
  for (const Triangle& f : mesh.F) {
    bool is_cut = false;
    for (int k = 0; k < 3 && !is_cut; ++k) {
      const int a = f[k], b = f[(k + 1) % 3], c = f[(k + 2) % 3];
      if (std::minmax(a, b) != std::minmax(0, 4)) continue;
      halves.push_back({a, middle, c});
      halves.push_back({middle, b, c});
      is_cut = true;
    }
    if (!is_cut) halves.push_back(f);
  }
  mesh.F = halves;
  const FollowedLines whole = follow_lines(mesh, polyline({Vec3(0, 0, 0), Vec3(1, 0, 0)}));
  EXPECT_FALSE(whole.fault);
  EXPECT_EQ(whole.n_edges, 2u);
  const FollowedLines parts =
      follow_lines(mesh, polyline({Vec3(0, 1, 0), Vec3(0, 1, .2), Vec3(0, 1, .9), Vec3(0, 1, 1), Vec3(0, 0, 1)}));
  EXPECT_FALSE(parts.fault);
  EXPECT_EQ(parts.n_edges, 2u);
}

TEST(FeatureLines, RepeatedAndCrossingLinesAreOneSet) {
  FeatureLines lines = square();
  const FeatureLines again = polyline({Vec3(.7, .3, 1), Vec3(.3, .3, 1)});
  for (const Vec3& x : again.points) lines.points.push_back(x);
  lines.segments.push_back({4, 5});
  lines.segments.push_back({5, 4});
  lines.segments.push_back({5, 5});
  const FollowedLines found = follow_lines(test::cube_with_imprint(), lines);
  EXPECT_FALSE(found.fault);
  EXPECT_EQ(found.n_edges, 4u);
}

TEST(FeatureLines, SixDigitsAreEnough) {
  TriangleMesh mesh = test::moved(test::cube_with_imprint(), Vec3(1, 2, 3) / 7., 1 / 3.);
  FeatureLines lines = square();
  for (Vec3& x : lines.points) {
    x = x / 3 + Vec3(1, 2, 3) / 7.;
    for (int a = 0; a < 3; ++a) x[a] = std::stod(std::to_string(x[a]));
  }
  EXPECT_EQ(follow_lines(mesh, lines).n_edges, 4u);
  for (Vec3& x : lines.points) x.x() += 1e-4;
  EXPECT_TRUE(follow_lines(mesh, lines).fault);
}

struct Wrong {
  const char* name;
  FeatureLines lines;
  int point;
  const char* words;
};

TEST(FeatureLines, FaultsHaveAPlace) {
  const Wrong wrong[] = {
      {"far", polyline({Vec3(.3, .3, 1), Vec3(.7, .3, 1), Vec3(.7, .3, 1.5)}), 2, "0.5 from the triangles"},
      {"in a face", polyline({Vec3(.3, .3, 1), Vec3(.5, .5, 1)}), 1, "a line ends there"},
      {"across a face", polyline({Vec3(1, 0, 1), Vec3(.3, .3, 1)}), 0, "no edge of the triangles runs along"},
      {"ends within an edge", polyline({Vec3(0, 0, 0), Vec3(.4, 0, 0)}), 1, "a line ends there"},
      {"closed, in a face", polyline({Vec3(.4, .5, 1), Vec3(.5, .4, 1), Vec3(.6, .5, 1)}, true), 0, "closed line"}};
  for (const Wrong& w : wrong) {
    SCOPED_TRACE(w.name);
    const FollowedLines found = follow_lines(test::cube_with_imprint(), w.lines);
    ASSERT_TRUE(found.fault);
    EXPECT_EQ(found.fault->point, w.point);
    EXPECT_NE(found.fault->what.find(w.words), std::string::npos) << found.fault->what;
    EXPECT_NE(found.fault->what.find("give lines along edges"), std::string::npos);
  }
  FeatureLines cross = polyline({Vec3(.3, .3, 1), Vec3(.45, .45, 1), Vec3(.7, .7, 1)});
  cross.points.emplace_back(.3, .7, 1);
  cross.segments.push_back({3, 1});
  const FollowedLines found = follow_lines(test::cube_with_imprint(), cross);
  ASSERT_TRUE(found.fault);
  EXPECT_NE(found.fault->what.find("lines cross there"), std::string::npos) << found.fault->what;
}

TEST(FeatureLines, LinesFarFromEverythingEndAtOnce) {
  FeatureLines lines;
  for (int k = 0; k < 20000; ++k) lines.points.emplace_back(1e50, k, 1e-300);
  for (int k = 0; k + 1 < 20000; ++k) lines.segments.push_back({k, k + 1});
  EXPECT_TRUE(follow_lines(test::cube(), lines).fault);
}

}  // namespace
}  // namespace umtet
