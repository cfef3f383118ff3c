#pragma once

#include <cstdint>
#include <vector>

#include "mesh/background/background_mesh.h"
#include "mesh/core/implicit_function.h"

namespace umtet::star_costs {

/// A smooth body from a seed, with exact first derivatives and Hessian: of one of three families, none of which holds a
/// shape that the mesher is accepted by.
class RandomShape {
 public:
  explicit RandomShape(std::uint64_t seed);

  double evaluate(const Vec3& x, Vec3* g, Mat3* H) const;
  double value(const Vec3& x) const { return evaluate(x, nullptr, nullptr); }
  Vec3 gradient(const Vec3& x) const {
    Vec3 g;
    evaluate(x, &g, nullptr);
    return g;
  }
  Mat3 hessian(const Vec3& x) const {
    Vec3 g;
    Mat3 H;
    evaluate(x, &g, &H);
    return H;
  }
  const Box& box() const { return box_; }

 private:
  enum class Family { Waves, Blobs, Superquadric };
  struct Wave {
    Vec3 k;
    double phase, amplitude;
  };
  struct Blob {
    Vec3 centre;
    double width;
  };

  Family family_;
  Mat3 rotation_ = Mat3::Identity();  ///< no shape is aligned with the lattice
  Vec3 centre_ = Vec3::Zero();
  Vec3 axes_ = Vec3::Ones();
  double exponent_ = 2;
  std::vector<Wave> waves_;  ///< psi = |x|^2 - 1 + sum amplitude sin(k x + phase)
  std::vector<Blob> blobs_;  ///< psi = 1/2 - sum exp(-|x - c|^2 / width^2)
  Box box_;
};

}  // namespace umtet::star_costs
