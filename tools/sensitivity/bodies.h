#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "mesh/background/background_mesh.h"
#include "mesh/core/implicit_function.h"

namespace umtet::sensitivity {

/// A body in some pose, with exact derivatives.
struct Body {
  std::string name;
  Box box;      ///< holds the closure of the body
  Vec3 offset;  ///< of the lattice against the box, cells; 0 .. 1
  double n_tets = 0;
  std::function<double(const Vec3&, Vec3*, Mat3*)> psi;

  double value(const Vec3& x) const { return psi(x, nullptr, nullptr); }
  Vec3 gradient(const Vec3& x) const {
    Vec3 g;
    psi(x, &g, nullptr);
    return g;
  }
  Mat3 hessian(const Vec3& x) const {
    Vec3 g;
    Mat3 H;
    psi(x, &g, &H);
    return H;
  }
  double evaluate(const Vec3& x, Vec3* g, Mat3* H) const { return psi(x, g, H); }
};

/// The same bodies for the same seed, whatever the platform: 66 random shapes of star_costs, and ten known domains in
/// six poses each. In two poses of six the lattice is shifted against a domain, in four the domain is turned, too.
/// @param seed  0: those of the table; others: bodies that share nothing with them but the families
std::vector<Body> bodies(std::uint64_t seed);

}  // namespace umtet::sensitivity
