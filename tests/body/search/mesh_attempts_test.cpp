#include "body/search/mesh_attempts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace umtet {
namespace {

constexpr int kInverted = -1, kEmpty = -2;
// Meshes without reasons, with a defect each that is small.
constexpr int kSmallFold = 100, kSmallCut = 101;
// Meshes with a reason: a large fold, and a lack of what h = .9 or .6 shows.
constexpr int kFold = 102, kThin = 103, kVeryThin = 104;
// A mesh that lacks a handle, and nothing thin explains it.
constexpr int kHandle = 105;
// Half of a fold's boundary is where no sample is, and a handle of psi that no sample supports.
constexpr int kGuessed = 106, kGuessedHandle = 107;
constexpr double kAnyEffort = 1000;

MeshAttempt with_defect(const MeshDefect& defect) {
  MeshAttempt a;
  a.defects = {defect};
  a.measured.defects = report_on(a.defects);
  if (!is_small(defect)) a.reasons = {"a defect"};
  return a;
}

MeshAttempt guessed(double share, int n_handles) {
  MeshAttempt a = with_defect({.kind = DefectKind::Folded, .off_over_h = .8, .size_over_h = 9});
  a.measured.domain.support = SupportReport{.radius = .3};
  a.measured.domain.support->unsupported_area_fraction = share;
  a.measured.domain.support->n_guessed_handles = n_handles;
  return a;
}

MeshAttempt ended_as(int outcome) {
  switch (outcome) {
    case kSmallFold:
      return with_defect({.kind = DefectKind::Folded, .off_over_h = .8});
    case kSmallCut:
      return with_defect({.kind = DefectKind::Cut, .off_over_h = .8});
    case kFold:
      return with_defect({.kind = DefectKind::Folded, .off_over_h = .8, .size_over_h = 9});
    case kThin:
      return with_defect({.kind = DefectKind::Thin, .off_over_h = 2, .feature_over_h = 2, .h_needed = .9 / .97});
    case kVeryThin:
      return with_defect({.kind = DefectKind::Thin, .off_over_h = 2, .h_needed = .6 / .97});
    case kGuessed:
      return guessed(.6, 0);
    case kGuessedHandle:
      return guessed(.3, 1);
    case kHandle:
      return with_defect({.kind = DefectKind::Topology, .off_over_h = 2});
    default:
      break;
  }
  MeshAttempt a;
  if (outcome < 0) {
    a.result.status = outcome == kEmpty ? UmStatus::EmptyDomain : UmStatus::InvertedTet;
    a.result.evidence.what = "no mesh";
  }
  a.reasons.assign(static_cast<std::size_t>(std::max(0, outcome)), "a hole");
  return a;
}

/// What is kept when the k-th attempt ends as outcomes[k]: a number of reasons, or one of those above.
struct Story {
  explicit Story(const std::vector<int>& outcomes, double effort = kDefaultEffort, EdgeLength choice = {1, 0}) {
    AttemptsWithOneH attempts(choice, effort, [&](const std::string& line) { said.push_back(line); });
    while (const std::optional<double> h = attempts.next_h()) {
      MeshAttempt a = ended_as(outcomes.at(tried.size()));
      a.h = *h;
      tried.push_back(*h);
      attempts.add(std::move(a));
    }
    kept = attempts.take_best();
  }
  std::vector<double> tried;
  std::vector<std::string> said;
  MeshAttempt kept;
};

using H = std::vector<double>;

TEST(AttemptsWithOneH, SmallDefectsAreNamedAndNotChased) {
  for (const int outcome : {0, kSmallFold, kSmallCut}) {
    EXPECT_EQ(Story({outcome}).tried, H{1});
    EXPECT_TRUE(Story({outcome}).said.empty());
  }
}

TEST(AttemptsWithOneH, AWholeMeshIsMadeAgainOnceAndOnlyWhereItIsForecastToPass) {
  EXPECT_EQ(Story({kFold, kFold}).tried, (H{1, .985})) << "folds come and go with h";
  EXPECT_EQ(Story({kThin, kThin}).tried, (H{1, .9})) << "the h that shows it";
  EXPECT_EQ(Story({kVeryThin}).tried, H{1}) << "1 + 1 / .6^3 is more than the effort";
  EXPECT_EQ(Story({kHandle}).tried, H{1}) << "no h is known to show it";
  EXPECT_EQ(Story({kEmpty}).tried, H{1});
  EXPECT_EQ(Story({kInverted}).tried, H{1}) << "nothing thin explains it";
}

TEST(AttemptsWithOneH, WhatPsiInventsIsNotMeshedAgain) {
  EXPECT_EQ(Story({kGuessed}).tried, H{1});
  EXPECT_EQ(Story({kGuessedHandle}).tried, H{1});
  EXPECT_EQ(Story({kGuessed, 0}, 8).tried.size(), 2U) << "unless the user spends more";
}

TEST(AttemptsWithOneH, TheBetterMeshIsKept) {
  EXPECT_EQ(Story({kFold, 0}).kept.h, .985);
  EXPECT_EQ(Story({kFold, kSmallFold}).kept.h, .985);
  const Story s({kFold, kInverted});
  EXPECT_EQ(s.kept.h, 1);
  EXPECT_NE(s.said.back().find("keeping h = 1"), std::string::npos) << s.said.back();
}

TEST(AttemptsWithOneH, WhatNoiseHidesIsTriedWithMoreEffortOnly) {
  const EdgeLength of_noise = {.h = 1, .least = 0, .of_thin_parts = .5};
  EXPECT_EQ(Story({kThin}, kDefaultEffort, of_noise).tried, H{1});
  EXPECT_EQ(Story({kFold, 0}, kDefaultEffort, of_noise).tried, (H{1, .985}));
  EXPECT_EQ(Story({kThin, 0}, 8, of_noise).tried, (H{1, .5}));
}

TEST(AttemptsWithOneH, NeverGoesBelowTheLeastH) {
  EXPECT_EQ(Story({kInverted}, kAnyEffort, {1, 1}).tried, H{1}) << "a given h is its own least";
  EXPECT_EQ(Story({kFold}, kDefaultEffort, {1, .99}).tried, H{1});
  EXPECT_EQ(Story({1, 1, 1, 1}, kAnyEffort, {1, .7}).tried, (H{1, .985, .8, .7}));
}

TEST(AttemptsWithOneH, MoreEffortChasesSmallFoldsAndTriesMore) {
  EXPECT_EQ(Story({kSmallFold, 0}, 8).tried, (H{1, .985}));
  EXPECT_EQ(Story({kSmallCut}, 8).tried, H{1}) << "no h is known to do without";
  EXPECT_EQ(Story({1, 1, 1, 1}, 8).tried, (H{1, .985, .8, .8 * .8}));
  EXPECT_EQ(Story({kVeryThin, 0}, 8).tried, (H{1, .6}));
  EXPECT_EQ(Story({kThin, kThin, 0}, 8).tried.size(), 3u);
}

TEST(AttemptsWithOneH, EndsWhereTheEffortIsSpent) {
  // 1, 1/.985^3 = 1.05, 1/.8^3 = 1.95, 3.8, 7.5
  EXPECT_EQ(Story({1}, 1.5).tried.size(), 1u);
  EXPECT_EQ(Story({1, 1, 1}, 5).tried.size(), 3u);
  EXPECT_EQ(Story({1, 1, 1, 1, 1}, 16).tried.size(), 5u);
}

/// Attempts on graded meshes: reasons and tets of each; every refinement halves h, until h_min.
struct Refinements {
  Refinements(const std::vector<std::pair<int, int>>& outcomes, double h_min, double effort = kAnyEffort) {
    const auto attempt = [&](double h, const MeshAttempt* former) {
      formers.push_back(former ? former->h : 0);
      const auto [n_reasons, n_tets] = outcomes.at(tried.size());
      tried.push_back(h);
      MeshAttempt a;
      a.h = h;
      if (n_reasons < 0) a.result.status = UmStatus::InvertedTet;
      a.reasons.assign(static_cast<std::size_t>(std::max(0, n_reasons)), "a hole");
      a.result.submesh.mesh.C.resize(static_cast<std::size_t>(n_tets));
      return a;
    };
    const auto refine = [&](const MeshAttempt& a) { return a.h > h_min ? std::optional(a.h / 2) : std::nullopt; };
    kept = refined_attempt(1, effort, attempt, refine, [&](const std::string& line) { said.push_back(line); });
  }
  std::vector<double> tried, formers;  ///< 0: none
  std::vector<std::string> said;
  MeshAttempt kept;
};

TEST(RefinedAttempt, EndsWithTheFirstFaithfulMesh) {
  EXPECT_EQ(Refinements({{0, 100}}, 0).tried.size(), 1u);
  const Refinements r({{2, 100}, {kInverted, 0}, {0, 130}}, 0);
  EXPECT_EQ(r.tried, (std::vector<double>{1, .5, .25}));
  EXPECT_TRUE(r.kept.is_right());
  EXPECT_EQ(r.said.size(), 2u);
}

TEST(RefinedAttempt, KeepsTheBestWhereNothingMayBeFiner) {
  const Refinements r({{2, 100}, {1, 110}, {3, 120}}, .25);
  EXPECT_EQ(r.tried.size(), 3u);
  EXPECT_EQ(r.kept.h, .5);
  EXPECT_NE(r.said.back().find("keeping those of 110 tets"), std::string::npos) << r.said.back();
  EXPECT_EQ(r.formers, (std::vector<double>{0, 1, .5}));
  EXPECT_EQ(Refinements({{1, 100}, {1, 110}, {1, 120}, {1, 130}, {1, 140}}, 0).tried.size(), 5u);  // four refinements
}

TEST(RefinedAttempt, EndsWhereAllHaveMadeMoreTetsThanEffortAllows) {
  EXPECT_EQ(Refinements({{1, 100}, {1, 150}, {1, 0}}, 0, 3).tried.size(), 2u);
  EXPECT_EQ(Refinements({{1, 100}}, 0, 1).tried.size(), 1u);
}

TEST(FinerWhereItFailed, HalvesTheSizesOfWhatSmallerEdgesMayMend) {
  MeshAttempt a;
  a.sizes =
      std::make_shared<const SizeField>(std::vector<SizeSource>{{Vec3::Zero(), .2, 10}}, SizeFieldParams{.h_min = .01});
  a.defects = {{.kind = DefectKind::Folded, .where = Vec3(1, 0, 5), .off_over_h = .2, .size_over_h = 3},
               {.kind = DefectKind::Cut, .where = Vec3(2, 0, 5), .feature_over_h = .5}};
  const std::vector<SizeSource> finer = finer_where_it_failed(a, Vec3(0, 0, 5), kDefaultEffort);
  ASSERT_EQ(finer.size(), 1u);  // the cut is as good as h can show
  EXPECT_EQ(finer[0].x, Vec3(1, 0, 0));
  EXPECT_NEAR(finer[0].h, .1, 1e-12);
  EXPECT_NEAR(finer[0].radius, .5 * 3 * .2 + 2 * .2, 1e-12);
  a.result.status = UmStatus::InvertedTet;
  a.result.evidence.where = Vec3(0, 1, 0);
  a.defects.clear();
  const std::vector<SizeSource> where_it_ended = finer_where_it_failed(a, Vec3(0, 0, 5), kDefaultEffort);
  ASSERT_EQ(where_it_ended.size(), 1u);
  EXPECT_EQ(where_it_ended[0].x, Vec3(0, 1, 0));
}

}  // namespace
}  // namespace umtet
