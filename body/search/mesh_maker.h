#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "body/body.h"
#include "body/options.h"
#include "body/pieces/zero_set_choice.h"
#include "body/search/mesh_attempts.h"
#include "body/search/part_maker.h"
#include "body/sizing/background_choice.h"
#include "body/sizing/thick_body.h"
#include "common/context.h"
#include "common/message.h"
#include "mesh/background/background_mesh.h"
#include "mesh/universal_mesh.h"

namespace umtet {

/// What is said to the user while a mesh is made; either may be empty, and may throw, which ends the work.
struct MeshLines {
  std::function<void(const Message& line)> say = {};         ///< what the user should know
  std::function<void(const std::string& line)> detail = {};  ///< what explains a result
};

using MakeBackground = std::function<SizedBackground(double h)>;

/// Meshes a domain and measures what came out, as MeshOptions says: the one way that leads to the meshes of `umtet
/// mesh`, `umtet evolve` and Python's umtet.mesh.
class MeshMaker {
 public:
  /// The domain stays where it is. The context is told of "components", the steps of
  /// choose_submesh() and fit_submesh(), "certify" and "second order"; fractions are those of one attempt.
  /// @param ranks  make the mesh, where several processes do; null: this one does
  /// \throw UsageError as um_params()
  MeshMaker(Domain& domain, BodyOptions options, Context context, MeshLines lines = {}, PartMaker* ranks = nullptr);

  /// psi, cut for h, meshed in this background. A mesh whose certificate fails is a result; so is none.
  /// \throw MeshingImpossible  no sample is near psi = 0; Cancelled
  MeshAttempt attempt(const SizedBackground& background, double h) { return attempt(background, h, nullptr); }

  /// The best_attempt() from this h on, each in a background of its own; where sizes vary, the refined_attempt(). Where
  /// the choice between the two is ours and one h does not do, sizes that vary are tried after all, if
  /// may_improve() and they make no more than mesh.effort times the tets of that h. Where mesh.tets
  /// asks for a number that h misses by more than a tenth, which shows before anything is moved, another h takes its
  /// place.
  /// @param choice  of `backgrounds`
  /// @param make    backgrounds.make(), and what else is to happen before an attempt
  MeshAttempt best(BackgroundChoice& backgrounds, const EdgeLength& choice, const MakeBackground& make);

  /// The pieces of psi = 0, psi cut for h: kept until another h is asked for.
  /// @param sizes  for a graded mesh, of which h is the least. \throw Cancelled
  const ZeroSetChoice& pieces_at(double h, const SizeField* sizes = nullptr);

 private:
  /// An attempt, and which tets it is about or, where several processes make it, what it has become.
  struct Begun {
    MeshAttempt attempt;
    ChosenSubmesh chosen;
    std::optional<MadeInParts> made = {};

    bool is_possible() const { return made || chosen.status == UmStatus::Success; }
    std::size_t n_tets() const { return made ? made->n_chosen_tets : chosen.n_tets; }
  };
  MeshAttempt begin(const SizedBackground& background, double h);
  Begun choose(const SizedBackground& background, double h, const MeshAttempt* former);
  ChosenSubmesh choose(const BackgroundMesh& background, const ZeroSetChoice& pieces, const MeshAttempt* former);
  std::optional<MadeInParts> made_by_ranks(const SizedBackground& background, const ZeroSetChoice& pieces, double h);
  MeshAttempt finish(const SizedBackground& background, Begun begun);
  void fit(const SizedBackground& background, ChosenSubmesh chosen, MeshAttempt& a);
  void flip(MeshAttempt& a) const;
  UmParams params_for(const ZeroSetChoice& pieces, double h) const;
  const TriangleThickness* thin_triangles(const BackgroundMesh& background, const ZeroSetChoice& pieces, double h);
  KnownSigns known_signs(const BackgroundMesh& background, const ZeroSetChoice& pieces) const;
  bool may_keep(const MeshAttempt& former, const ZeroSetChoice& pieces) const;
  MeshAttempt attempt(const SizedBackground& background, double h, const MeshAttempt* former);
  MeshAttempt attempt_for_tets(double h, const MakeBackground& make, const MeshAttempt* former = nullptr);
  MeshAttempt search(BackgroundChoice& backgrounds, const EdgeLength& choice, const MakeBackground& make);
  MeshAttempt graded(BackgroundChoice& backgrounds, double h, const MakeBackground& make);
  void curve(MeshAttempt& a) const;
  void say(const Message& line) const {
    if (lines_.say) lines_.say(line);
  }

  Domain& domain_;
  const BodyOptions options_;
  const Context context_;
  const MeshLines lines_;
  const UmParams params_;
  PartMaker* const ranks_;
  std::optional<std::pair<double, ZeroSetChoice>> pieces_;  ///< of psi cut for the h beside them
  int n_levels_ = 0;                                        ///< of psi then; 0: a formula
  int n_attempts_ = 0;
  /// Of the triangles, up to what the h beside it asks for, once that has been measured.
  std::optional<std::pair<double, TriangleThickness>> thickness_;
  bool is_thickened_ = false;  ///< the vertices that were chosen last
  bool has_said_alone_ = false;
};

/// What is wrong, and the first of the thin places; some lines, without a newline at the end. Coordinates are those of
/// the model: `shift` is added. \pre !attempt.thin.empty()
std::string too_thin_text(const MeshAttempt& attempt, const Vec3& shift);

}  // namespace umtet
