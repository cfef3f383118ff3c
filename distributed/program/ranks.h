#pragma once

#include <mpi.h>

#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "distributed/program/held_mesh.h"
#include "pipeline/case/parameters.h"
#include "pipeline/domain/domain.h"
#include "pipeline/meshing/part_mesher.h"

// The ranks of the program: rank 0 runs it, the others do with it what it says.
namespace umtet {

/// What a rank makes meshes of.
struct RankInput {
  Parameters parameters;
  Domain domain;
};

/// Of rank 0. The others serve() meanwhile.
class Ranks final : public PartMesher {
 public:
  /// @param section  the parameters of a mesh, as text: all ranks have to have the same
  explicit Ranks(MPI_Comm comm) : comm_(comm) {}
  /// Lets the others go, with the exit code of the program. Collective.
  void end(int code);

  std::optional<MadeInParts> make(const BackgroundMesh& background, ImplicitFunctionRef psi, const FastParams& params,
                                  const RoundedPlaces& places) override;

 private:
  class Handle;

  MPI_Comm comm_;
  std::int64_t next_ = 0;
  std::map<std::int64_t, HeldMesh> held_;
};

/// Of the other ranks: does what rank 0 says, until it says the end. @return the exit code
/// @param input  is called when the first mesh is to be made
int serve(MPI_Comm comm, const std::function<RankInput()>& input);

}  // namespace umtet
