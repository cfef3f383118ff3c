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

/// Returns whether the options require a graded mesh: by mesh.background or, if this is "auto", by sizes.
bool is_graded(const BodyOptions&);

/// \throw UsageError  sizes are given for a background that is not graded, or sizes contradict each other
void require_graded(const BodyOptions&);

/// The edge lengths of a graded background: the lengths that the boundary of one or more domains requires, and those
/// that the user requests. A common factor scales them, for a number of tets or for another attempt; h is always the
/// length of the smallest edges.
class GradedSizes {
 public:
  /// @param shift  shift of all domains
  /// \throw any exception of options.sizes
  GradedSizes(BodyOptions options, const Vec3& shift);

  /// For a body of triangles with sharp edges, adds its feature_sizes(), with at most mesh.h, by default .04 of the
  /// diagonal. Curved patches have at most mesh.max_deviation, by default 5e-4 of the diagonal.
  ///
  /// For others, adds the sizes that psi = 0 of this domain requires: mesh.h (by default a tenth of the diagonal if
  /// mesh.max_deviation is given, else .015 of the diagonal), reduced according to thickness, the turn of the normal,
  /// mesh.max_deviation and BodyOptions::label_sizes; with mesh.grade_inside only mesh.h. Sizes are at least
  /// mesh.h_min; by default at least h / 16 and noise / .3. psi has the detail for h_min, also on return.
  /// @param most_tets  if some of the sizes already make more tets than this, the search for sizes ends
  /// @return false if the search ended for this reason; no sizes were added
  /// \throw MeshingImpossible  psi = 0 nowhere in the box
  /// \throw UsageError  contradictory options; also a size function that is not positive on psi = 0 or inside, if
  ///                    mesh.h_min is not given
  /// \throw Cancelled
  bool add(Domain& domain, const Context& context = {}, double most_tets = std::numeric_limits<double>::infinity());

  /// Adds smaller sizes where a mesh failed. The comparison uses all sizes times h / finest(). Sizes do not fall below
  /// mesh.h_min or, if it is not given, a quarter of the default minimum. These sources need not be met exactly.
  /// @return the least size after the change, with the same factor; empty if no size may be smaller
  std::optional<double> refine(const std::vector<SizeSource>& wanted, double h);

  int n_domains() const { return n_domains_; }  ///< number of domains that were added
  /// Returns the least unscaled size on the boundary and inside. \pre add() has been called
  double finest() const { return finest_; }
  /// Returns the field of all sizes times h / finest(); `grade` does not change. \throw Cancelled
  SizeField field(double h, const Context& context = {}) const;

 private:
  void require_lengths(const std::vector<Vec3>& inside) const;
  void add_edges(const Domain& domain, const Context& context);
  void find_finest(const Domain& domain, const Context& context);

  const BodyOptions options_;
  const Vec3 shift_;
  std::vector<SizeSource> asked_;               ///< requested by the caller
  std::vector<SizeSource> finer_;               ///< added where a mesh failed
  std::function<double(const Vec3&)> formula_;  ///< function of the caller, or empty
  std::string formula_name_;
  std::vector<SizeSource> sources_;  ///< required by psi = 0
  Box box_;
  double h_min_ = 0, finest_ = 0;
  int n_domains_ = 0;
};

/// Returns the least size on the features of a body of triangles with sharp edges, for a mesh of one edge length.
/// \pre domain.has_edges_of_triangles()
double least_edged_size(const Domain& domain, const MeshOptions& options, const Context& context = {});

/// Returns the approximate factor of h that divides the number of tets by n.
double h_ratio_of_tets(double n);

/// Returns the h for about n_tets tets, by the estimate of the library. \throw MeshingImpossible  psi < 0 nowhere
double h_of_graded_tets(const GradedSizes& sizes, const Domain& domain, double n_tets, const Context& context = {});

}  // namespace umtet
