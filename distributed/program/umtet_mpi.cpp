// The program of several processes: mpirun -n N umtet_mpi run CLOUD ...

#include <mpi.h>
#include <sys/resource.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <memory>
#include <utility>
#include <variant>

#include "distributed/program/rank_signals.h"
#include "distributed/program/ranks.h"
#include "distributed/program/serve.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/case/memory.h"
#include "pipeline/cli/command_line.h"
#include "pipeline/cli/program.h"

namespace umtet {
namespace {

int rank_of(MPI_Comm comm) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  return rank;
}

// Address space that Open MPI 4.1 maps at the start, 220 MB here (VmPeak before and after MPI_Init_thread()), plus the
// needs of a mesh. If Open MPI cannot map all of it, it waits for ever or crashes.
constexpr double kLeastAddresses = 3.2e8;

/// Returns false, with a message, if the limit of the address space (ulimit -v) is too low for MPI.
bool has_addresses() {
  rlimit limit{};
  double pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY || pages == 0) return true;
  const auto most = static_cast<double>(limit.rlim_cur);
  if (most - pages * static_cast<double>(::sysconf(_SC_PAGESIZE)) > kLeastAddresses) return true;
  std::fprintf(stderr, "umtet: %.0f MB of addresses (ulimit -v) are not enough for MPI and a mesh\n", most / 1e6);
  return false;
}

/// Returns the mesh parameters of a call that several processes support. \throw UsageError as parse_command_line()
Parameters parameters_of(int argc, char** argv) {
  Command command = parse_command_line(argc, argv).command;
  if (auto* evolve = std::get_if<EvolveCommand>(&command)) return std::move(evolve->request.parameters);
  if (auto* of_case = std::get_if<ExportCommand>(&command)) return std::move(of_case->parameters);
  return std::move(std::get<RunCommand>(command).request.parameters);
}

/// Runs a rank other than 0. Rank 0 reports errors of a call; the other ranks only parse a correct one.
int run_other_rank(int argc, char** argv, int n_here) {
  set_work_at_hand("mesh");
  std::unique_ptr<tbb::global_control> threads;
  return serve(MPI_COMM_WORLD, [&] {
    const CommandLine call = parse_command_line(argc, argv);
    const int n =
        call.options.threads > 0 ? call.options.threads : std::max(1, tbb::info::default_concurrency() / n_here);
    threads = std::make_unique<tbb::global_control>(tbb::global_control::max_allowed_parallelism,
                                                    static_cast<std::size_t>(n));
    Parameters parameters = parameters_of(argc, argv);
    if (const double most = parameters.output().max_memory; most > 0) limit_memory(1e9 * most, n);
    return parameters;
  });
}

}  // namespace
}  // namespace umtet

int main(int argc, char** argv) {
  using namespace umtet;
  keep_freed_memory();
  std::signal(SIGXFSZ, SIG_IGN);  // exceeding a limit on files is then an error of write()
  if (!has_addresses()) return static_cast<int>(ExitCode::ResourceLimit);  // this also ends the other processes
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  const bool speaks = rank_of(MPI_COMM_WORLD) == 0;
  RanksOfProgram ranks;
  ranks.n_here = n_ranks_here(MPI_COMM_WORLD);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks.n);
  Ranks mesher(MPI_COMM_WORLD, ranks.n_here, [&] { return parameters_of(argc, argv).section("mesh"); });
  ranks.mesher = &mesher;
  if (speaks) install_signal_handlers();
  if (ranks.n > 1) share_signals(rank_of(MPI_COMM_WORLD));
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
