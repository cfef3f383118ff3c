#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "body/body.h"
#include "body/options.h"
#include "common/context.h"
#include "mesh/sizes/size_field.h"

namespace umtet {

/// The options ask for a graded mesh: by mesh.background or, where it is "auto", because sizes are given.
bool is_graded(const BodyOptions&);

/// \throw UsageError where sizes are given for a background that has its own, or sizes that contradict each other
void require_graded(const BodyOptions&);

/// The edge lengths that a graded background is made for: what the boundary of one or more domains needs, and what the
/// user asks for. They are known up to a factor, for a number of tets or for another attempt; h is always that of the
/// smallest edges.
class GradedSizes {
 public:
  /// @param shift  of the domains to come
  /// \throw what options.sizes throws
  GradedSizes(BodyOptions options, const Vec3& shift);

  /// Takes in what psi = 0 of this domain asks for: mesh.h (or a tenth of the diagonal where mesh.max_deviation
  /// decides, else .015 of it), less by thickness, by the turn of the normal, by mesh.max_deviation and by
  /// BodyOptions::label_sizes; with mesh.grade_inside mesh.h alone. Not below mesh.h_min, or a sixteenth of h and what
  /// noise / .3 allows. psi is looked at with all the detail that sizes of h_min show; on return it is cut there.
  /// @param most_tets  where some of the sizes already make more tets, the others are not looked for
  /// @return false then, and nothing was taken in
  /// \throw MeshingImpossible  psi = 0 nowhere in the box; UsageError, also for a formula that is not above 0 on
  ///        psi = 0 or inside, if there is no mesh.h_min; Cancelled
  bool add(Domain& domain, const Context& context = {}, double most_tets = std::numeric_limits<double>::infinity());

  /// Asks for less where a mesh failed, with all sizes times h / finest(): where that is not below mesh.h_min, or a
  /// quarter of the floor without it. Such sources are no more than asked for.
  /// @return h with the same factor, of what is the finest then; none where nothing may be finer
  std::optional<double> refine(const std::vector<SizeSource>& wanted, double h);

  int n_domains() const { return n_domains_; }  ///< that were taken in
  /// The h of the sizes as they are: the least on the boundary, and inside. \pre add() has been called
  double finest() const { return finest_; }
  /// All sizes times h / finest(); `grade` is kept. \throw Cancelled
  SizeField field(double h, const Context& context = {}) const;

 private:
  void require_lengths(const std::vector<Vec3>& inside) const;
  void find_finest(const Domain& domain, const Context& context);

  const BodyOptions options_;
  const Vec3 shift_;
  std::vector<SizeSource> asked_;               ///< by the caller
  std::vector<SizeSource> finer_;               ///< where a mesh failed
  std::function<double(const Vec3&)> formula_;  ///< the caller's, or none
  std::string formula_name_;
  std::vector<SizeSource> sources_;  ///< of psi = 0
  Box box_;
  double h_min_ = 0, finest_ = 0;
  int n_domains_ = 0;
};

/// By what about h changes if there are to be 1 / n as many tets.
double h_ratio_of_tets(double n);

/// The h at which about n tets are taken, by the estimate of the library. \throw MeshingImpossible  psi < 0 nowhere
double h_of_graded_tets(const GradedSizes& sizes, const Domain& domain, double n_tets, const Context& context = {});

}  // namespace umtet
