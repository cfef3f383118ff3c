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

// The ranks of the program as seen by rank 0, which runs it. The other ranks execute its commands in serve().
namespace umtet {

/// Interface of rank 0 to all ranks. The other ranks run serve().
class Ranks final : public PartMesher, public BandRefiner {
 public:
  /// @param n_here  number of ranks on this machine
  /// @param call    returns the parameters of a mesh; called before the first mesh, to check that all ranks have the
  ///                same parameters
  Ranks(MPI_Comm comm, int n_here, std::function<Json()> call) : comm_(comm), n_here_(n_here), call_(std::move(call)) {}
  /// Ends the other ranks with the exit code of the program. Collective.
  void end(int code);
  /// Releases the local mesh of this rank, made by make(), with positions in model coordinates; serve() gives the other
  /// ranks their local meshes. Collective, once per mesh.
  TakenMesh release(const MeshInParts& mesh);

  double allowed_bytes(const Parameters& parameters) const override;
  /// \throw UsageError if the other ranks were called for another mesh
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
  bool has_told_ = false;          ///< the other ranks have the domain
  std::optional<double> t_;        ///< time t of this domain
  std::map<int, BandPart> bands_;  ///< bands to be refined
  /// The level set that the other ranks have; this copy lacks the last band of refine().
  std::optional<LevelSet> shared_;
  int n_shared_ = 0;  ///< number of its levels
  std::int64_t next_ = 0;
  std::map<std::int64_t, HeldMesh> held_;
};

/// Returns the number of ranks on this machine. Collective.
int n_ranks_here(MPI_Comm comm);

}  // namespace umtet
