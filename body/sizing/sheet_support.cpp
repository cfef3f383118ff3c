#include "body/sizing/sheet_support.h"

#include <array>
#include <cstddef>

#include "body/pieces/zero_set_choice.h"

namespace umtet {

SheetSupport::SheetSupport(const Domain& domain)
    : domain_(domain), radius_(support_radius(domain)), tree_(domain.cloud.points) {}

bool SheetSupport::operator()(const Vec3& x, const Vec3& gradient) const {
  // Some of the nearest samples are on the other side of a rim, however thin it is. So these are as many as a sample has
  // around it on one sheet.
  constexpr std::size_t kNearest = 8;
  std::array<Neighbour, kNearest> room;
  for (const Neighbour& near : tree_.k_nearest(x, room))
    if (near.distance2 <= radius_ * radius_ && domain_.cloud.normals[near.point].dot(gradient) > 0) return true;
  return false;
}

}  // namespace umtet
