#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "body/body.h"
#include "body/options.h"
#include "body/sizing/edge_length.h"
#include "body/sizing/graded_sizes.h"
#include "mesh/background/background_mesh.h"
#include "mesh/sizes/body_size.h"

namespace umtet {

/// Returns the tiling that `background` names; a15() if the library chooses.
/// \throw std::invalid_argument  there is no tiling of this name
const Tiling& tiling_of(const MeshOptions&);

/// Returns whether the caller provides the background mesh: `mesh.background` is neither a tiling nor "graded".
bool has_own_background(const BodyOptions&);

/// \throw UsageError  mesh.box_walls with another background than a15, or mesh.complement without mesh.box_walls
void require_walls(const BodyOptions&);

/// Returns the method that classifies the vertices of a mesh with these options: fast mode chooses the inside vertices
/// if the background is a tiling without walls.
ClassificationSource classification_source(const BodyOptions&);

/// A background mesh, the box that it was requested to cover and, if it is graded, its sizes.
struct SizedBackground {
  BackgroundMesh mesh;
  Box box = {};
  std::shared_ptr<const SizeField> sizes = nullptr;
};

/// Makes the background mesh according to MeshOptions::background and box_walls: a lattice or a box with a given edge
/// length, a graded mesh with a given least edge length, or the mesh of the caller.
class BackgroundChoice {
 public:
  /// Stores the background mesh of the caller, if there is one, or the sizes.
  /// \throw UsageError  h or a number of tets is given for a background of the caller; also as require_walls() and
  ///                    GradedSizes, and any exception of a function in the options
  BackgroundChoice(BodyOptions options, const Domain& domain);

  /// Returns the edge length of the caller's background, if there is one.
  std::optional<double> own_h() const { return given_ ? std::optional(given_->h()) : std::nullopt; }
  /// Returns the edge length of the caller's background, the least of the sizes that this and all earlier domains
  /// require, or choose_edge_length(). If the background is "auto", and neither h nor max_deviation is given, the first
  /// domain decides, provided that it is fitted to samples or a segmentation: the mesh is graded if this takes less
  /// than half of the tets of the one h that thin parts require.
  /// \throw as choose_edge_length() and GradedSizes::add()
  EdgeLength edge_length(Domain& domain, const Context& context = {});
  /// Changes to a graded mesh with the sizes that this domain requires, after one h did not resolve all of it.
  /// @return the edge length; empty if the options do not leave the choice to the library, as above
  /// \throw as edge_length()
  std::optional<EdgeLength> grade(Domain& domain, const Context& context = {});
  /// Undoes grade().
  void drop_grading() { graded_.reset(), known_.reset(); }
  /// Returns the approximate number of tets for the one h that thin parts require, if the mesh is graded for this
  /// reason; otherwise 0.
  double uniform_tets() const { return uniform_tets_; }
  /// Calls GradedSizes::refine(). \pre is_graded()
  std::optional<double> refine(const std::vector<SizeSource>& wanted, double h);
  bool is_graded() const { return graded_.has_value(); }
  /// Returns the approximate number of tets of a mesh of this domain with edge length h.
  double expected_tets(const Domain& domain, double h) const;
  /// Returns the h for about mesh.max_tets tets. \throw MeshingImpossible  psi < 0 nowhere
  double least_h(const Domain& domain) const;
  /// Makes the background mesh for edge length h.
  /// @param n_tets   requested number of tets, or 0
  /// @param allowed  bytes of memory that the mesh may use
  /// \throw ResourceLimit
  /// \pre edge_length() has been called if the mesh is graded
  SizedBackground make(const Domain& domain, double h, std::int64_t n_tets, double allowed,
                       const Context& context = {}) const;

 private:
  bool may_be_graded(const Domain& domain) const;
  double one_h_by_edges(const Domain& domain, const Context& context) const;
  EdgeLength edge_length_by_edges(Domain& domain, const Context& context);
  void grade_if_worth_it(Domain& domain, const EdgeLength& one, const Context& context);
  EdgeLength graded_edge_length(const Domain& domain, const Context& context) const;
  /// Returns the sizes for h, and keeps them for the next call.
  const std::shared_ptr<const SizeField>& sizes_for(double h) const;
  BackgroundMesh graded(const Domain& domain, double h, const Context& context) const;

  const BodyOptions options_;
  std::optional<BackgroundMesh> given_;
  std::optional<GradedSizes> graded_;
  /// The last request to graded_.
  struct Known {
    double h;
    std::shared_ptr<const SizeField> sizes;
    std::optional<double> n_tets;  ///< expected number of tets, if there is only one domain
  };
  mutable std::optional<Known> known_;
  const bool is_ours_;       ///< mesh.background is auto, and no sizes are given
  bool is_decided_ = false;  ///< the first domain has decided whether the mesh is graded
  double uniform_tets_ = 0;
  const Tiling* tiling_;  ///< tiling for the estimate of the number of tets, also with a background of the caller
  ClassificationSource source_;
  bool walls_;
};

}  // namespace umtet
