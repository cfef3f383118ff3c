#include "body/fidelity/mesh_defect.h"

#include <gtest/gtest.h>

#include "body/fidelity/accepted_defects.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/reports/certificate_report.h"

namespace umtet {
namespace {

/// A place larger than a few faces, unless its size is given.
MeshDefect defect(DefectKind kind, double off, std::optional<double> feature = .5, double size = 10) {
  return {.kind = kind, .off_over_h = off, .size_over_h = size, .feature_over_h = feature};
}

TEST(MeshDefect, IsSmallWhereItIsNearAndFinerThanHCanShow) {
  EXPECT_TRUE(is_small(defect(DefectKind::Folded, .5, 1.2)));
  EXPECT_FALSE(is_small(defect(DefectKind::Folded, .51, 1.2)));
  EXPECT_TRUE(is_small(defect(DefectKind::Thin, 1, 1.2)));
  EXPECT_FALSE(is_small(defect(DefectKind::Thin, 1.01, 1.2)));
  EXPECT_FALSE(is_small(defect(DefectKind::Folded, 0, 1.25)));
  EXPECT_FALSE(is_small(defect(DefectKind::Folded, 0, std::nullopt)));  // nothing explains it
}

TEST(MeshDefect, IsSmallWhereItIsNoDeeperThanHAndNoLargerThanAFewFaces) {
  for (const DefectKind kind :
       {DefectKind::Folded, DefectKind::Off, DefectKind::Filled, DefectKind::Cut, DefectKind::Thin}) {
    EXPECT_TRUE(is_small(defect(kind, 1, std::nullopt, kSmallSize))) << to_string(kind);
    EXPECT_FALSE(is_small(defect(kind, 1.01, std::nullopt, kSmallSize))) << to_string(kind);
    EXPECT_FALSE(is_small(defect(kind, 1, std::nullopt, kSmallSize + .01))) << to_string(kind);
  }
  EXPECT_FALSE(is_small(defect(DefectKind::Topology, .1, std::nullopt, 0))) << "a handle is no matter of size";
}

TEST(MeshDefect, KindsAreReadAsTheyAreWritten) {
  for (int k = 0; k <= static_cast<int>(DefectKind::Missed); ++k) {
    const auto kind = static_cast<DefectKind>(k);
    EXPECT_EQ(defect_kind_of(to_string(kind)), kind);
  }
  EXPECT_EQ(defect_kind_of("fold"), std::nullopt);
}

TEST(MeshDefect, AreListedWorstFirstAndCounted) {
  std::vector<MeshDefect> defects = {defect(DefectKind::Cut, .3), defect(DefectKind::Folded, .1, std::nullopt),
                                     defect(DefectKind::Cut, .4)};
  for (std::size_t k = 0; k < kListedDefects; ++k) defects.push_back(defect(DefectKind::Filled, .01));
  const DefectReport report = report_on(defects);
  EXPECT_EQ(report.n(), kListedDefects + 3);
  EXPECT_EQ(report.listed.size(), kListedDefects);
  EXPECT_EQ(report.listed[0].kind, DefectKind::Folded);  // not small, though nearest but for the filled ones
  EXPECT_EQ(report.listed[1].off_over_h, .4);
  ASSERT_EQ(report.kinds.size(), 3u);
  EXPECT_EQ(report.kinds[0].n_small, 0u);
  EXPECT_EQ(report.kinds[2].kind, DefectKind::Cut);
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
  std::vector<MeshDefect> defects = {defect(DefectKind::Folded, .1)};
  m.defects = report_on(defects);
  EXPECT_EQ(judge_shape(m).word(), "pass with 1 defect named");
  EXPECT_TRUE(judge_shape(m).fits_psi);
  EXPECT_FALSE(judge_shape(m, true).passes());
  EXPECT_TRUE(judge_shape(m, true, "folded").passes());
  EXPECT_EQ(judge_shape(m, true, "folded:.1").accepted.size(), 1u);
  EXPECT_FALSE(judge_shape(m, true, "folded:.05").passes());
  EXPECT_FALSE(judge_shape(m, true, "off").passes());
  defects.push_back(defect(DefectKind::Off, .6));
  m.defects = report_on(defects);
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
