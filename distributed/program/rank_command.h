#pragma once

#include <mpi.h>

#include <cstdint>
#include <string>
#include <vector>

#include "distributed/fit/part_refine.h"
#include "mesh/core/implicit_function.h"
#include "body/body.h"
#include "pipeline/meshing/part_mesher.h"

// What rank 0 says to the others, who do it with it.
namespace umtet {

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

/// An order and its numbers: those that it has no use for are as they are here. It is sent as bytes.
struct RankCommand {
  RankOrder order = RankOrder::End;
  std::int64_t mesh = 0;   ///< its number; of the end the exit code
  std::int64_t state = 0;  ///< a MeshState, of pieces a PieceFormat, of samples their level
  std::int64_t moving_alone = 0;
  std::int64_t has_data = 0;   ///< of pieces: a PieceData
  std::int64_t is_fitted = 0;  ///< the domain: there is a level set of samples, else psi is that of the call
  std::int64_t has_t = 0;      ///< the domain: of a formula that is taken at t
  double t = 0;
  double lattice_h = 0, h = 0, shift[3] = {}, rounding = 0;
  double box[2][3] = {};  ///< of the domain; of a mesh what its background was asked to cover
  double kappa = 0, tolerance = 0;
  double spacing = 0;  ///< of the finest level that is kept
  std::int64_t max_iterations = 0;

  void set_places(const RoundedPlaces& places);
  RoundedPlaces places() const { return {h, Vec3(shift[0], shift[1], shift[2]), rounding}; }
  void set_box(const Box& b);
  Box given_box() const { return {Vec3(box[0]), Vec3(box[1])}; }
  RefineParams refine_params() const { return {kappa, tolerance, static_cast<int>(max_iterations)}; }
};

/// What belongs to it and has any length.
struct Attached {
  std::string file = {};         ///< that is written
  std::vector<Vec3> seeds = {};  ///< of a mesh
};

struct Heard {
  RankCommand command;
  Attached attached;
};

/// Of rank 0: to all others, who hear() it. Collective with that.
void say(MPI_Comm comm, const RankCommand& command, const Attached& attached = {});

/// Of the other ranks, which sleep until rank 0 says something.
Heard hear(MPI_Comm comm);

}  // namespace umtet
