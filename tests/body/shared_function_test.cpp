// A function without another owner lives as long as the last copy of a SharedFunction.

#include "body/shared_function.h"

#include <gtest/gtest.h>

#include <optional>

namespace umtet {
namespace {

/// |x|^2 - r^2 with a count of what is left of it.
struct Ball {
  std::shared_ptr<int> alive = std::make_shared<int>(1);
  double r = 1;
  double evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const {
    if (gradient) *gradient = 2 * x;
    if (hessian) *hessian = 2 * Mat3::Identity();
    return x.squaredNorm() - r * r;
  }
};

TEST(SharedFunction, LivesAsLongAsItsLastCopy) {
  Ball ball;
  const std::weak_ptr<int> alive = ball.alive;
  std::optional<SharedFunction> first = shared_function(std::move(ball));
  std::optional<SharedFunction> second = first;
  first.reset();
  EXPECT_FALSE(alive.expired());
  EXPECT_EQ(second->ref().value({2, 0, 0}), 3);
  EXPECT_TRUE(second->ref().has_hessian());
  second.reset();
  EXPECT_TRUE(alive.expired());
}

}  // namespace
}  // namespace umtet
