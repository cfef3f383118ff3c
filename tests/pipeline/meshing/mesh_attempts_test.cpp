#include "pipeline/meshing/mesh_attempts.h"

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
// Meshes without reasons, with a place each that is small.
constexpr int kFold = 100, kCut = 101;
// A mesh that lacks a part that is not small.
constexpr int kThin = 102;
constexpr double kAnyEffort = 1000;

/// What is kept when the k-th attempt ends as outcomes[k]: a number of reasons, or one of those above.
struct Story {
  explicit Story(const std::vector<int>& outcomes, double least = 0, double effort = kAnyEffort) {
    const auto attempt = [&](double h) {
      MeshAttempt a;
      a.h = h;
      const int outcome = outcomes.at(tried.size());
      tried.push_back(h);
      if (outcome < 0) {
        a.result.status = outcome == kEmpty ? UmStatus::EmptyDomain : UmStatus::InvertedTet;
        a.result.evidence.what = "no mesh";
      } else if (outcome == kFold || outcome == kCut) {
        const PlaceKind kind = outcome == kFold ? PlaceKind::Folded : PlaceKind::Cut;
        a.places = {{.kind = kind, .off_over_h = .1, .feature_over_h = .5}};
        a.measured.places = report_on(a.places);
      } else if (outcome == kThin) {
        a.places = {{.kind = PlaceKind::Thin, .off_over_h = 2, .feature_over_h = 2}};
        a.measured.places = report_on(a.places);
        a.reasons = {"the mesh lacks what is thin"};
      } else {
        a.reasons.assign(static_cast<std::size_t>(outcome), "a hole");
      }
      return a;
    };
    kept = best_attempt({1, least}, effort, attempt, [&](const std::string& line) { said.push_back(line); });
  }
  std::vector<double> tried;
  std::vector<std::string> said;
  MeshAttempt kept;
};

TEST(BestAttempt, AMeshWithReasonsIsNotLostToALaterFailure) {
  const Story s({1, kInverted, kInverted, kInverted, kInverted});
  EXPECT_EQ(s.tried.size(), 5u);
  EXPECT_EQ(s.kept.h, 1);
  EXPECT_TRUE(s.kept.made());
  EXPECT_NE(s.said.back().find("keeping h = 1"), std::string::npos) << s.said.back();
}

TEST(BestAttempt, FewerReasonsAreBetterThenTheSmallerH) {
  EXPECT_DOUBLE_EQ(Story({3, 2, 1, 2, 2}).kept.h, .8);
  EXPECT_DOUBLE_EQ(Story({2, 2, 2, 3, 2}).kept.h, .512);
  EXPECT_DOUBLE_EQ(Story({kInverted, 5, kInverted, 6}).kept.h, .8);
  EXPECT_DOUBLE_EQ(Story({kInverted, kInverted, kInverted, kInverted}).kept.h, .512);
}

TEST(BestAttempt, AFoldIsTriedWithHardlyMoreTetsFirst) {
  EXPECT_EQ(Story({1, 0}).tried, (std::vector<double>{1, .985}));
  EXPECT_DOUBLE_EQ(Story({1, 0}).kept.h, .985);
  EXPECT_EQ(Story({1, 1, 0}).tried, (std::vector<double>{1, .985, .8}));
  EXPECT_EQ(Story({kInverted, 0}).tried, (std::vector<double>{1, .8}));  // no mesh at all is no accident
  EXPECT_EQ(Story({1, 1}, .97).tried, (std::vector<double>{1, .985}));
  EXPECT_EQ(Story({1}, .99).tried.size(), 1u);
}

TEST(BestAttempt, WhatIsThinIsNotTriedWithHardlyMoreTets) {
  EXPECT_EQ(Story({kThin, 0}).tried, (std::vector<double>{1, .8}));
  EXPECT_EQ(Story({kFold, kThin, 0}).tried, (std::vector<double>{1, .985, .8}));
  EXPECT_EQ(Story({kThin, kFold, 0}).tried.size(), 3u) << "from .8 it goes on to .64";
}

TEST(BestAttempt, StopsAtTheFirstMeshWithoutReasonsAndWhereASmallerHCannotHelp) {
  EXPECT_EQ(Story({0}).tried.size(), 1u);
  EXPECT_TRUE(Story({0}).said.empty());
  EXPECT_EQ(Story({2, 2, kInverted, 0}).tried.size(), 4u);
  EXPECT_DOUBLE_EQ(Story({2, 2, kInverted, 0}).kept.h, .64);
  EXPECT_EQ(Story({kEmpty}).tried.size(), 1u);
  // An attempt for a number of tets may have come to another h than it was asked for.
  std::vector<std::string> said;
  const auto elsewhere = [](double h) {
    MeshAttempt a;
    a.h = 1.1 * h;
    return a;
  };
  best_attempt({1, 1}, kAnyEffort, elsewhere, [&](const std::string& line) { said.push_back(line); });
  EXPECT_TRUE(said.empty());
  // A given h is its own least: it is taken as it is.
  EXPECT_EQ(Story({kInverted}, 1).tried.size(), 1u);
  // The least is tried where four fifths would go below, unless it is next to the last one.
  EXPECT_EQ(Story({1, 1, 1, 1}, .7).tried, (std::vector<double>{1, .985, .8, .7}));
  EXPECT_EQ(Story({1, 1, 1}, .78).tried.size(), 3u);
}

TEST(BestAttempt, ASmallFoldMayGoWithAnotherHAndASmallCutIsNoReasonToTryOne) {
  EXPECT_EQ(Story({kFold, 0}).tried.size(), 2u);
  EXPECT_EQ(Story({kCut}).tried.size(), 1u);
  // A fold is better than a reason, and none is better than one.
  EXPECT_EQ(Story({kFold, 1, 1, 1, 1}).kept.h, 1);
  EXPECT_DOUBLE_EQ(Story({kFold, 1, kCut}).kept.h, .8);
}

TEST(BestAttempt, EndsWhereTheEffortIsSpent) {
  // 1, 1/.985^3 = 1.05, 1/.8^3 = 1.95, 3.8, 7.5
  EXPECT_EQ(Story({1}, 0, 2).tried.size(), 1u);
  EXPECT_EQ(Story({1, 1}, 0, 2.1).tried.size(), 2u);
  EXPECT_EQ(Story({1, 1, 1}, 0, 5).tried.size(), 3u);
  EXPECT_EQ(Story({1, 1, 1, 1}, 0, 8).tried.size(), 4u);
  EXPECT_EQ(Story({1, 1, 1, 1, 1}, 0, 16).tried.size(), 5u);
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
  a.places = {{.kind = PlaceKind::Folded, .where = Vec3(1, 0, 5), .size_over_h = 3},
              {.kind = PlaceKind::Cut, .where = Vec3(2, 0, 5), .feature_over_h = .5}};
  const std::vector<SizeSource> finer = finer_where_it_failed(a, Vec3(0, 0, 5));
  ASSERT_EQ(finer.size(), 1u);  // the cut is as good as h can show
  EXPECT_EQ(finer[0].x, Vec3(1, 0, 0));
  EXPECT_NEAR(finer[0].h, .1, 1e-12);
  EXPECT_NEAR(finer[0].radius, .5 * 3 * .2 + 2 * .2, 1e-12);
  a.result.status = UmStatus::InvertedTet;
  a.result.evidence.where = Vec3(0, 1, 0);
  a.places.clear();
  const std::vector<SizeSource> where_it_ended = finer_where_it_failed(a, Vec3(0, 0, 5));
  ASSERT_EQ(where_it_ended.size(), 1u);
  EXPECT_EQ(where_it_ended[0].x, Vec3(0, 1, 0));
}

}  // namespace
}  // namespace umtet
