#include "pipeline/meshing/mesh_attempts.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace umtet {
namespace {

constexpr int kInverted = -1, kEmpty = -2;

/// What is kept when the k-th attempt ends as outcomes[k]: a number of reasons, or one of the failures above.
struct Story {
  explicit Story(const std::vector<int>& outcomes, double least = 0) {
    const auto attempt = [&](double h) {
      MeshAttempt a;
      a.h = h;
      const int outcome = outcomes.at(tried.size());
      tried.push_back(h);
      if (outcome < 0) {
        a.result.status = outcome == kEmpty ? UmStatus::EmptyDomain : UmStatus::InvertedTet;
        a.result.evidence.what = "no mesh";
      } else {
        a.measured.reasons.assign(static_cast<std::size_t>(outcome), "a folded face");
      }
      return a;
    };
    kept = best_attempt({1, least}, attempt, [&](const std::string& line) { said.push_back(line); });
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
  best_attempt({1, 1}, elsewhere, [&](const std::string& line) { said.push_back(line); });
  EXPECT_TRUE(said.empty());
  // A given h is its own least: it is taken as it is.
  EXPECT_EQ(Story({kInverted}, 1).tried.size(), 1u);
  // The least is tried where four fifths would go below, unless it is next to the last one.
  EXPECT_EQ(Story({1, 1, 1, 1}, .7).tried, (std::vector<double>{1, .985, .8, .7}));
  EXPECT_EQ(Story({1, 1, 1}, .78).tried.size(), 3u);
}

}  // namespace
}  // namespace umtet
