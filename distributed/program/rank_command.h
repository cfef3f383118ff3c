#pragma once

#include <mpi.h>

#include <cstdint>
#include <string>
#include <vector>

#include "body/body.h"
#include "distributed/fit/part_refine.h"
#include "mesh/core/implicit_function.h"
#include "pipeline/meshing/part_mesher.h"

// Commands of rank 0 to the other ranks, which execute them together with it.
namespace umtet {

/// Kind of a command.
enum class RankOrder : std::int64_t {
  LevelSet,
  CutLevelSet,
  TakeSamples,
  Refine,
  Domain,
  Make,
  Curve,
  Write,
  WriteQuality,
  WritePieces,
  Release,
  Drop,
  End
};

/// A command with its numeric arguments; unused ones keep their defaults. It is sent as bytes.
struct RankCommand {
  RankOrder order = RankOrder::End;
  std::int64_t mesh = 0;   ///< number of the mesh; for End the exit code
  std::int64_t state = 0;  ///< a MeshState; for pieces a PieceFormat; for samples their level
  std::int64_t moving_alone = 0;
  std::int64_t has_data = 0;  ///< for pieces: 1 if there is a PieceData
  /// For the domain: 1 if psi is a level set fitted to samples, 0 if psi is given in the call.
  std::int64_t is_fitted = 0;
  std::int64_t has_t = 0;  ///< for the domain: 1 if psi is a formula at time t
  double t = 0;
  double lattice_h = 0, h = 0, shift[3] = {}, rounding = 0;
  double box[2][3] = {};  ///< box of the domain; for a mesh, the box that its background must cover
  double kappa = 0, tolerance = 0;
  double spacing = 0;  ///< spacing of the finest level to be kept
  std::int64_t max_iterations = 0;

  void set_places(const RoundedPlaces& places);
  RoundedPlaces places() const { return {h, Vec3(shift[0], shift[1], shift[2]), rounding}; }
  void set_box(const Box& b);
  Box given_box() const { return {Vec3(box[0]), Vec3(box[1])}; }
  RefineParams refine_params() const { return {kappa, tolerance, static_cast<int>(max_iterations)}; }
};

/// Arguments of variable length.
struct Attached {
  std::string file = {};         ///< output file
  std::vector<Vec3> seeds = {};  ///< seeds of a mesh
};

/// A command as received by the other ranks.
struct Heard {
  RankCommand command;
  Attached attached;
};

/// Sends a command from rank 0 to all others, which call hear(). Collective with hear().
void say(MPI_Comm comm, const RankCommand& command, const Attached& attached = {});

/// Receives a command on the other ranks, which sleep until rank 0 sends one.
Heard hear(MPI_Comm comm);

}  // namespace umtet
