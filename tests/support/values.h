#pragma once

#include "common/vec3.h"

namespace umtet::testing {

/// Any callable as an implicit function, for what needs values only.
template <typename F>
struct Values {
  F f;
  double value(const Vec3& x) const { return f(x); }
  Vec3 gradient(const Vec3&) const { return Vec3::Zero(); }
};
template <typename F>
Values(F) -> Values<F>;

}  // namespace umtet::testing
