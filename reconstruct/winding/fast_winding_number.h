#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "reconstruct/cloud/point_cloud.h"
#include "reconstruct/winding/sample_tree.h"

namespace umtet {

struct WindingNumberParams {
  double beta = 2;  ///< a cluster of samples is one term from beta times its radius on; > 1, or infinity: all samples
  double softening = 1;  ///< r_i over the radius sqrt(a_i / pi) of the disc that sample i stands for; >= 0
};
std::vector<std::string> problems(const WindingNumberParams&);

/// How often the samples wind around a place: 1 inside of a closed surface with outward normals, 0 outside, what part
/// of the sphere of directions meets the surface where it is open                                     [Barill2018, eq.
/// (5)]
///
///     w(x) = sum_i a_i n_i . (x_i - x) g_i(|x_i - x|) / (4 pi),    g_i(d) = 1 / d^3                       for d >= r_i
///                                                                 g_i(d) = (5 - 3 d^2 / r_i^2) / (2 r_i^3)     below
///
/// Below r_i a sample is no point but the ball of density ~ 1 - d^2 / r_i^2, so that w has a continuous gradient, and
/// near 1/2, and bounded, at the samples themselves [Lin2022]. Elsewhere nothing is softened.
///
/// Samples are in a binary tree. One of its nodes, seen from x beyond beta times its radius, is a Taylor series about
/// its centre of area: a dipole, and the two terms after it [Barill2018, Section 3]. With beta = 2 w is off by
/// .001 on average, and by .02 at worst.
class FastWindingNumber {
 public:
  /// Normals need not be unit: sums of a_i n_i over merged samples are as good. Areas are >= 0.
  /// \throw std::invalid_argument  no points, 2^31 or more, other numbers of normals or areas, one that is not finite,
  ///        a problem of params
  /// Cost: O(n log n), about a microsecond a sample; 250 bytes a sample.
  FastWindingNumber(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const std::vector<double>& areas,
                    const WindingNumberParams& params = {});

  /// The same samples with other normals: a tenth of the cost. \throw std::invalid_argument  as above
  void set_normals(const std::vector<Vec3>& normals);
  /// Charges s_i in place of normals. What evaluate() then gives as gradient is - sum a_i s_i (x_i - x) g_i / (4 pi):
  /// at the samples, the adjoint of the map from normals to w, but for whose r_i is taken. Its value means nothing.
  /// \throw std::invalid_argument  as above
  void set_charges(const std::vector<double>& charges);
  /// Another softening, for the same normals. \throw std::invalid_argument  not finite, or < 0
  void set_softening(double softening);

  /// w(x). Cost: O(log n). May be called from several threads. Does not depend on the number of threads.
  double operator()(const Vec3& x) const { return evaluate(x, nullptr); }
  /// w(x), and its gradient, which points inward near the surface.
  double evaluate(const Vec3& x, Vec3* gradient) const;
  /// Both at many places, from all threads. @param gradients  null, or filled
  std::vector<double> evaluate(const std::vector<Vec3>& places, std::vector<Vec3>* gradients = nullptr) const;

  std::size_t size() const { return samples_.size(); }

 private:
  struct Sample {
    Vec3 x, moment;                  ///< x_i, a_i n_i
    double area, charge, softening;  ///< a_i, a_i s_i, r_i
    std::uint32_t number;            ///< in the order of the caller
  };
  struct Node : SampleTreeNode {
    double radius = 0, far = 0;         ///< of the samples about the centre; distance from which on the series is used
    double charge = 0;                  ///< sum a s
    Vec3 centre = Vec3::Zero();         ///< of area
    Vec3 dipole = Vec3::Zero();         ///< sum a (n + s d)
    std::array<double, 6> second = {};  ///< sum a sym(d n + s d d / 2), d = x_i - centre: xx yy zz xy xz yz
    std::array<double, 10> third = {};  ///< sum a sym(d d n / 2 + s d d d / 6): xxx yyy zzz xxy xxz xyy yyz xzz yzz xyz
  };
  double beta_;
  std::vector<Sample> samples_;
  std::vector<Node> nodes_;  ///< parents before children

  void find_ball(Node& node) const;
  void find_moments(Node& node) const;
  void update_moments();
};

}  // namespace umtet
