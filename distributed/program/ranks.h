#pragma once

#include <mpi.h>

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "distributed/fit/part_refine.h"
#include "distributed/program/held_mesh.h"
#include "pipeline/case/json_values.h"
#include "pipeline/case/parameters.h"
#include "pipeline/meshing/part_mesher.h"

// The ranks of the program as rank 0 has them, which runs it: the others do with it what it says, in serve().
namespace umtet {

/// Of rank 0. The others serve() meanwhile.
class Ranks final : public PartMesher, public BandRefiner {
 public:
  /// @param n_here  ranks on this machine
  /// @param call  its parameters of a mesh, asked for when the first is to be made: all ranks have to have the same
  Ranks(MPI_Comm comm, int n_here, std::function<Json()> call) : comm_(comm), n_here_(n_here), call_(std::move(call)) {}
  /// Lets the others go, with the exit code of the program. Collective.
  void end(int code);
  /// What this rank has of a mesh that make() made, with the places of the model; the others have theirs from serve().
  /// Collective, once a mesh.
  TakenMesh release(const MeshInParts& mesh);

  double allowed_bytes(const Parameters& parameters) const override;
  /// \throw UsageError where the others were called for another mesh
  std::optional<MadeInParts> make(const BackgroundMesh& background, const Box& box, const Domain& domain,
                                  const FastParams& params, const std::vector<Vec3>& seeds,
                                  const RoundedPlaces& places) override;
  void forget_domain(std::optional<double> t) override;
  int n() const override;
  void set_threads(int n) override { threads_ = n; }
  BandRefiner* bands() override { return n() > 1 ? this : nullptr; }
  void take(int level, const Lattice& lattice, int half_width, std::vector<SsdSample> samples) override;
  LevelSet refine(const LevelSet& psi, double kappa, double tolerance, int max_iterations,
                  const std::function<void(double residual)>& go_on, BandReport& report) override;

 private:
  class Handle;
  void tell(const Domain& domain);
  void share(const LevelSet& psi);
  template <class F>
  auto with_all(const char* then, const F& work) const;

  MPI_Comm comm_;
  int n_here_;
  std::function<Json()> call_;
  int threads_ = 1;
  bool has_told_ = false;           ///< the others have the domain
  std::optional<double> t_;         ///< of it
  std::map<int, BandPart> bands_;   ///< that are to be refined
  std::optional<LevelSet> shared_;  ///< that the others have, here without the last band of refine()
  int n_shared_ = 0;                ///< its levels
  std::int64_t next_ = 0;
  std::map<std::int64_t, HeldMesh> held_;
};

/// How many of these ranks are on this machine. Collective.
int n_ranks_here(MPI_Comm comm);

}  // namespace umtet
