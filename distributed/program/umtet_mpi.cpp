// The program of several processes: mpirun -n N umtet_mpi mesh --implicit EXPR ...

#include <mpi.h>
#include <tbb/global_control.h>
#include <tbb/info.h>

#include <algorithm>
#include <csignal>
#include <memory>
#include <utility>
#include <variant>

#include "distributed/program/ranks.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/cli/command_line.h"
#include "pipeline/cli/program.h"

namespace umtet {
namespace {

int rank_of(MPI_Comm comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

/// Ranks, of all and of those on this machine.
RanksOfProgram ranks_of(MPI_Comm comm, PartMesher* mesher) {
  RanksOfProgram ranks{mesher};
  MPI_Comm here = MPI_COMM_NULL;
  MPI_Comm_size(comm, &ranks.n);
  MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
  MPI_Comm_size(here, &ranks.n_here);
  MPI_Comm_free(&here);
  return ranks;
}

/// Rank 0 says what is wrong with a call; the others need it only where nothing is.
int run_other_rank(int argc, char** argv, int n_here) {
  set_work_at_hand("mesh");
  std::unique_ptr<tbb::global_control> threads;
  return serve(MPI_COMM_WORLD, [&] {
    const CommandLine call = parse_command_line(argc, argv);
    const int n =
        call.options.threads > 0 ? call.options.threads : std::max(1, tbb::info::default_concurrency() / n_here);
    threads = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                    static_cast<std::size_t>(n));
    const auto& request = std::get<RunCommand>(call.command).request;
    return RankInput{request.parameters, load_domain(CasePaths{request.case_folder}, request.parameters)};
  });
}

}  // namespace
}  // namespace umtet

int main(int argc, char** argv) {
  using namespace umtet;
  keep_freed_memory();
  std::signal(SIGXFSZ, SIG_IGN);  // a limit on files is an error of write()
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  const bool speaks = rank_of(MPI_COMM_WORLD) == 0;
  if (speaks) install_signal_handlers();
  Ranks mesher(MPI_COMM_WORLD);
  const RanksOfProgram ranks = ranks_of(MPI_COMM_WORLD, &mesher);
  int code = 0;
  if (speaks) {
    code = run_program(argc, argv, ranks);
    mesher.end(code);
  } else {
    code = run_other_rank(argc, argv, ranks.n_here);
  }
  MPI_Finalize();
  return code;
}
