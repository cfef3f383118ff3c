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

/// Receivers of messages while a mesh is made. Each may be empty. If one throws, the work ends with its exception.
struct MeshLines {
  std::function<void(const Message& line)> say = {};         ///< facts that the user should know
  std::function<void(const std::string& line)> detail = {};  ///< details that explain a result
};

using MakeBackground = std::function<SizedBackground(double h)>;

/// Meshes a domain according to MeshOptions and measures the mesh. `umtet mesh`, `umtet evolve` and umtet.mesh in
/// Python all use it.
class MeshMaker {
 public:
  /// The domain must outlive this object and must not move. The context receives reports of "components", the steps of
  /// choose_submesh() and fit_submesh(), "certify" and "second order"; fractions refer to one attempt.
  /// @param ranks  makes the mesh in several processes; null: this process makes the mesh
  /// \throw UsageError  as um_params()
  MeshMaker(Domain& domain, BodyOptions options, Context context, MeshLines lines = {}, PartMaker* ranks = nullptr);

  /// Meshes psi with the detail for h in this background. It also returns a mesh whose certificate fails, and an
  /// attempt without a mesh.
  /// \throw MeshingImpossible  no sample is near psi = 0; Cancelled
  MeshAttempt attempt(const SizedBackground& background, double h);

  /// Returns the best of AttemptsWithOneH from choice.h on, with a new background for each attempt, or
  /// refined_attempt() if sizes vary. If the library chooses between one h and varying sizes, and the best attempt with
  /// one h is not good, it also tries varying sizes, provided that may_improve() and that these make no more than
  /// mesh.effort times as many tets. If the number of tets differs from mesh.tets by more than a tenth, which is known
  /// before vertices move, another h is used.
  /// @param choice  edge length that `backgrounds` chose
  /// @param make    calls backgrounds.make(), and does all other work before an attempt
  MeshAttempt best(BackgroundChoice& backgrounds, const EdgeLength& choice, const MakeBackground& make);

  /// Returns the pieces of psi = 0 with the detail for h. The result is kept until the function is called with another
  /// h.
  /// @param sizes  sizes of a graded mesh, whose minimum is h; null for one h
  /// \throw Cancelled
  const ZeroSetChoice& pieces_at(double h, const SizeField* sizes = nullptr);

 private:
  /// An attempt in progress: its chosen tets or, if several processes make it, the finished mesh.
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
  void fit_edges(const SizedBackground& background, ChosenSubmesh chosen, MeshAttempt& a);
  void flip(MeshAttempt& a) const;
  UmParams params_for(const ZeroSetChoice& pieces, double h) const;
  const TriangleThickness* thin_triangles(const BackgroundMesh& background, const ZeroSetChoice& pieces, double h);
  KnownSigns known_signs(const BackgroundMesh& background, const ZeroSetChoice& pieces) const;
  bool may_keep(const MeshAttempt& former, const ZeroSetChoice& pieces) const;
  MeshAttempt attempt_for_tets(double h, const MakeBackground& make, const MeshAttempt* former = nullptr);
  MeshAttempt or_graded(MeshAttempt of_one_h, BackgroundChoice& backgrounds, double first_h,
                        const MakeBackground& make);
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
  std::optional<std::pair<double, ZeroSetChoice>> pieces_;  ///< h, and the pieces of psi with the detail for h
  int n_levels_ = 0;                                        ///< number of levels of psi at this h; 0: a formula
  int n_attempts_ = 0;
  /// h, and the thickness of the triangles measured up to the limit for h; empty before the first measurement.
  std::optional<std::pair<double, TriangleThickness>> thickness_;
  bool is_thickened_ = false;  ///< the last choice of vertices used a thickened body
  bool has_said_alone_ = false;
};

/// Returns a text of several lines about the failure and the first thin places, without a newline at the end. Its
/// coordinates are model coordinates: working coordinates plus `shift`. \pre !attempt.thin.empty()
std::string too_thin_text(const MeshAttempt& attempt, const Vec3& shift);

}  // namespace umtet
