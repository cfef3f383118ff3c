#include "body/fidelity/mesh_place.h"

#include <gtest/gtest.h>

#include "pipeline/case/exit_code.h"
#include "body/fidelity/accepted_defects.h"
#include "pipeline/reports/certificate_report.h"

namespace umtet {
namespace {

/// A place larger than a few faces, unless its size is given.
MeshPlace place(PlaceKind kind, double off, std::optional<double> feature = .5, double size = 10) {
  return {.kind = kind, .off_over_h = off, .size_over_h = size, .feature_over_h = feature};
}

TEST(MeshPlace, IsSmallWhereItIsNearAndFinerThanHCanShow) {
  EXPECT_TRUE(is_small(place(PlaceKind::Folded, .5, 1.2)));
  EXPECT_FALSE(is_small(place(PlaceKind::Folded, .51, 1.2)));
  EXPECT_TRUE(is_small(place(PlaceKind::Thin, 1, 1.2)));
  EXPECT_FALSE(is_small(place(PlaceKind::Thin, 1.01, 1.2)));
  EXPECT_FALSE(is_small(place(PlaceKind::Folded, 0, 1.25)));
  EXPECT_FALSE(is_small(place(PlaceKind::Folded, 0, std::nullopt)));  // nothing explains it
}

TEST(MeshPlace, IsSmallWhereItIsNoDeeperThanHAndNoLargerThanAFewFaces) {
  for (const PlaceKind kind : {PlaceKind::Folded, PlaceKind::Off, PlaceKind::Filled, PlaceKind::Cut, PlaceKind::Thin}) {
    EXPECT_TRUE(is_small(place(kind, 1, std::nullopt, kSmallSize))) << to_string(kind);
    EXPECT_FALSE(is_small(place(kind, 1.01, std::nullopt, kSmallSize))) << to_string(kind);
    EXPECT_FALSE(is_small(place(kind, 1, std::nullopt, kSmallSize + .01))) << to_string(kind);
  }
  EXPECT_FALSE(is_small(place(PlaceKind::Topology, .1, std::nullopt, 0))) << "a handle is no matter of size";
}

TEST(MeshPlace, KindsAreReadAsTheyAreWritten) {
  for (int k = 0; k <= static_cast<int>(PlaceKind::Missed); ++k) {
    const auto kind = static_cast<PlaceKind>(k);
    EXPECT_EQ(place_kind_of(to_string(kind)), kind);
  }
  EXPECT_EQ(place_kind_of("fold"), std::nullopt);
}

TEST(MeshPlace, AreListedWorstFirstAndCounted) {
  std::vector<MeshPlace> places = {place(PlaceKind::Cut, .3), place(PlaceKind::Folded, .1, std::nullopt),
                                   place(PlaceKind::Cut, .4)};
  for (std::size_t k = 0; k < kListedPlaces; ++k) places.push_back(place(PlaceKind::Filled, .01));
  const PlaceReport report = report_on(places);
  EXPECT_EQ(report.n(), kListedPlaces + 3);
  EXPECT_EQ(report.listed.size(), kListedPlaces);
  EXPECT_EQ(report.listed[0].kind, PlaceKind::Folded);  // not small, though nearest but for the filled ones
  EXPECT_EQ(report.listed[1].off_over_h, .4);
  ASSERT_EQ(report.kinds.size(), 3u);
  EXPECT_EQ(report.kinds[0].n_small, 0u);
  EXPECT_EQ(report.kinds[2].kind, PlaceKind::Cut);
  EXPECT_EQ(report.kinds[2].n, 2u);
  EXPECT_EQ(report.kinds[2].max_off_over_h, .4);
}

TEST(AcceptedDefects, AreKindsAndHowMuchOfThem) {
  const auto accepted = parse_accepted_defects("thin,off:0.2,guessed:.6");
  ASSERT_EQ(accepted.size(), 3u);
  EXPECT_EQ(accepted[0].kind, "thin");
  EXPECT_FALSE(accepted[0].most);
  EXPECT_EQ(accepted[1].most, .2);
  EXPECT_TRUE(is_accepted(accepted, "off", .2));
  EXPECT_FALSE(is_accepted(accepted, "off", .21));
  EXPECT_FALSE(is_accepted(accepted, "folded", 0));
  EXPECT_TRUE(parse_accepted_defects("").empty());
  for (const char* bad : {"folds", "off:", "off:x", "off:-1", "off:0.2h", "off,,thin", "off:nan"}) {
    EXPECT_THROW(parse_accepted_defects(bad), UsageError) << bad;
  }
}

TEST(Judge, NamesSmallPlacesUnlessItIsStrictAndTakesWhatIsAccepted) {
  MeshMeasures m;
  std::vector<MeshPlace> places = {place(PlaceKind::Folded, .1)};
  m.places = report_on(places);
  EXPECT_EQ(judge_shape(m).word(), "pass with 1 defect named");
  EXPECT_TRUE(judge_shape(m).fits_psi);
  EXPECT_FALSE(judge_shape(m, true).passes());
  EXPECT_TRUE(judge_shape(m, true, "folded").passes());
  EXPECT_EQ(judge_shape(m, true, "folded:.1").accepted.size(), 1u);
  EXPECT_FALSE(judge_shape(m, true, "folded:.05").passes());
  EXPECT_FALSE(judge_shape(m, true, "off").passes());
  places.push_back(place(PlaceKind::Off, .6));
  m.places = report_on(places);
  EXPECT_EQ(judge_shape(m).word(), "fail");
  EXPECT_FALSE(judge_shape(m).fits_psi);
  EXPECT_EQ(judge_shape(m).reasons.size(), 1u);
  EXPECT_EQ(judge_shape(m).defects.size(), 1u);
  EXPECT_TRUE(judge_shape(m, false, "off").passes());
  m.reasons = {"a tet is inverted"};
  EXPECT_FALSE(judge_shape(m, false, "off").passes());
}

}  // namespace
}  // namespace umtet
