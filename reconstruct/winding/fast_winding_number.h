#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "reconstruct/cloud/point_cloud.h"
#include "reconstruct/winding/sample_tree.h"

namespace umtet {

/// Parameters of FastWindingNumber.
struct WindingNumberParams {
  double beta = 2;  ///< a cluster of samples is one term beyond beta times its radius; > 1, or infinity: no clusters
  double softening = 1;  ///< r_i relative to the radius sqrt(a_i / pi) of the disc that sample i represents; >= 0
};
std::vector<std::string> problems(const WindingNumberParams&);

/// Generalised winding number of oriented samples                                      [Barill2018, eq. (5)]
///
/// It is 1 inside of a closed surface with outward normals and 0 outside. For an open surface it is the fraction of the
/// sphere of directions that meets the surface.
///
///     w(x) = sum_i a_i n_i . (x_i - x) g_i(|x_i - x|) / (4 pi),    g_i(d) = 1 / d^3                       for d >= r_i
///                                                                 g_i(d) = (5 - 3 d^2 / r_i^2) / (2 r_i^3)     below
///
/// Below r_i a sample is not a point but a ball of density ~ 1 - d^2 / r_i^2. w then has a continuous gradient, and at
/// the samples themselves it is bounded and near 1/2 [Lin2022]. Elsewhere nothing is softened.
///
/// Samples are stored in a binary tree. Beyond beta times its radius, a node is evaluated as a Taylor series about its
/// centre of area: a dipole and the two terms after it [Barill2018, Section 3]. With beta = 2, w is off by .001 on
/// average, and by .02 at worst.
class FastWindingNumber {
 public:
  /// Normals need not be unit: sums of a_i n_i over merged samples are valid, too. Areas are >= 0.
  /// \throw std::invalid_argument for no points, 2^31 or more points, a different number of normals or areas, a value
  ///        that is not finite, or a problem of params
  /// Cost: O(n log n), about a microsecond per sample; 250 bytes per sample.
  FastWindingNumber(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const std::vector<double>& areas,
                    const WindingNumberParams& params = {});

  /// Replaces the normals of the samples, at a tenth of the cost of construction. \throw std::invalid_argument as the
  /// constructor
  void set_normals(const std::vector<Vec3>& normals);
  /// Sets charges s_i in place of normals. The gradient of evaluate() is then - sum a_i s_i (x_i - x) g_i / (4 pi). At
  /// the samples this is the adjoint of the map from normals to w, except for the choice of whose r_i is used. The
  /// value is then meaningless.
  /// \throw std::invalid_argument as the constructor
  void set_charges(const std::vector<double>& charges);
  /// Sets another softening for the same normals. \throw std::invalid_argument if it is not finite, or < 0
  void set_softening(double softening);

  /// w(x). Cost: O(log n). Thread-safe. Does not depend on the number of threads.
  double operator()(const Vec3& x) const { return evaluate(x, nullptr); }
  /// w(x), and its gradient, which points inward near the surface.
  double evaluate(const Vec3& x, Vec3* gradient) const;
  /// Values and gradients at many positions, by all threads. @param gradients  null, or receives the gradients
  std::vector<double> evaluate(const std::vector<Vec3>& places, std::vector<Vec3>* gradients = nullptr) const;

  std::size_t size() const { return samples_.size(); }

 private:
  struct Sample {
    Vec3 x, moment;                  ///< x_i, a_i n_i
    double area, charge, softening;  ///< a_i, a_i s_i, r_i
    std::uint32_t number;            ///< index in the order of the caller
  };
  struct Node : SampleTreeNode {
    double radius = 0, far = 0;  ///< radius of the samples about the centre; distance beyond which the series is used
    double charge = 0;           ///< sum a s
    Vec3 centre = Vec3::Zero();  ///< centre of area
    Vec3 dipole = Vec3::Zero();  ///< sum a (n + s d)
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
