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

/// The tiling that `background` names; a15() where it leaves the choice to us.
/// \throw std::invalid_argument  it names none
const Tiling& tiling_of(const MeshOptions&);

/// The caller brings the background mesh: `mesh.background` is no tiling and not graded.
bool has_own_background(const BodyOptions&);

/// \throw UsageError  mesh.box_walls with another background than a15, or mesh.complement without mesh.box_walls
void require_walls(const BodyOptions&);

/// What classifies the vertices in a mesh of these options: fast mode chooses in backgrounds that are a tiling and
/// have no walls.
ClassificationSource classification_source(const BodyOptions&);

/// A background mesh, the box that it was asked to cover, and the sizes that it was made for if it is graded.
struct SizedBackground {
  BackgroundMesh mesh;
  Box box = {};
  std::shared_ptr<const SizeField> sizes = nullptr;
};

/// What MeshOptions::background and box_walls ask for: a lattice or a box of any edge length, a graded mesh of any edge
/// length at its finest place, or a mesh that has its own.
class BackgroundChoice {
 public:
  /// Takes the background of the caller, if there is one, or the sizes.
  /// \throw UsageError  h or a number of tets is given for a background of the caller, or as require_walls() and
  ///        GradedSizes; what the functions of the options throw
  BackgroundChoice(BodyOptions options, const Domain& domain);

  /// That of the caller's background.
  std::optional<double> own_h() const { return given_ ? std::optional(given_->h()) : std::nullopt; }
  /// That of the caller's background, of the sizes that this domain and all former ones ask for, or
  /// choose_edge_length(). Where the background is "auto" and neither h nor max_deviation is given, the first domain
  /// decides, if it is a level set of samples: a graded mesh where that takes less than half the tets of the one h that
  /// its thin parts need. \throw as choose_edge_length() and GradedSizes::add()
  EdgeLength edge_length(Domain& domain, const Context& context = {});
  /// Where the choice is ours and one h has not shown all of this domain: takes the sizes that it asks for.
  /// @return none where the choice is not ours, as above. \throw as edge_length()
  std::optional<EdgeLength> grade(Domain& domain, const Context& context = {});
  /// Takes that back.
  void drop_grading() { graded_.reset(), known_.reset(); }
  /// About how many tets the h for thin parts would have made, where the mesh is graded because of that; else 0.
  double uniform_tets() const { return uniform_tets_; }
  /// Of a graded mesh: GradedSizes::refine().
  std::optional<double> refine(const std::vector<SizeSource>& wanted, double h);
  bool is_graded() const { return graded_.has_value(); }
  /// About how many tets of it are taken.
  double expected_tets(const Domain& domain, double h) const;
  /// The h at which about mesh.max_tets tets are made. \throw MeshingImpossible  psi < 0 nowhere
  double least_h(const Domain& domain) const;
  /// @param n_tets  that are wanted, or 0
  /// @param allowed  bytes
  /// \throw ResourceLimit \pre edge_length() has been called if it is graded
  SizedBackground make(const Domain& domain, double h, std::int64_t n_tets, double allowed,
                       const Context& context = {}) const;

 private:
  bool may_be_graded(const Domain& domain) const;
  void grade_if_worth_it(Domain& domain, const EdgeLength& one, const Context& context);
  EdgeLength graded_edge_length(const Domain& domain, const Context& context) const;
  /// The sizes for an h, kept for the next call.
  const std::shared_ptr<const SizeField>& sizes_for(double h) const;
  BackgroundMesh graded(const Domain& domain, double h, const Context& context) const;

  const BodyOptions options_;
  std::optional<BackgroundMesh> given_;
  std::optional<GradedSizes> graded_;
  /// What has been asked of graded_ last.
  struct Known {
    double h;
    std::shared_ptr<const SizeField> sizes;
    std::optional<double> n_tets;  ///< expected, where there is one domain
  };
  mutable std::optional<Known> known_;
  const bool is_ours_;       ///< mesh.background is auto, and no sizes are given
  bool is_decided_ = false;  ///< by the first domain
  double uniform_tets_ = 0;
  const Tiling* tiling_;  ///< that the number of tets is estimated by, for a background of the caller, too
  ClassificationSource source_;
  bool walls_;
};

}  // namespace umtet
