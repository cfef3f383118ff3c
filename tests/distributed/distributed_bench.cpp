// A torus of so many tets from all ranks: what each took.
//
// usage: mpirun -n N distributed_bench TETS        a line for each rank
//        distributed_bench TETS --one              the same by universal_mesh(), one process

#include <mpi.h>
#include <sys/resource.h>
#include <tbb/global_control.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "distributed/mesh/distributed_mesh.h"
#include "mesh/sizes/body_size.h"
#include "mesh/universal_mesh.h"
#include "tests/support/domains.h"

namespace {

struct Row {
  double n_tets, n_vertices, seconds, cpu, peak_MB, before_MB, messages, bytes, exchanges, reductions, gets, bytes_got;
};

double peak_MB(double* cpu = nullptr) {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  if (cpu) *cpu = static_cast<double>(usage.ru_utime.tv_sec) + 1e-6 * static_cast<double>(usage.ru_utime.tv_usec);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace umtet;
  int provided = 0, rank = 0, n_ranks = 1;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &n_ranks);
  const double n_tets = argc > 1 ? std::atof(argv[1]) : 1e6;
  const bool by_one = argc > 2 && std::string_view(argv[2]) == "--one";
  const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 1);
  const auto torus = testing::torus();
  const Vec3 more = Vec3::Constant(.1);
  const Box box(torus.box.min() - more, torus.box.max() + more);
  const BackgroundMesh background(a15(), box, h_for_tets(torus, box, n_tets, ClassificationSource::Chosen));
  const FastParams params;
  Row row{};
  row.before_MB = peak_MB();
  const auto start = std::chrono::steady_clock::now();
  if (by_one) {
    const UmResult made = universal_mesh(background, torus, {.fast = params});
    row.n_tets = static_cast<double>(made.submesh.mesh.C.size());
    row.n_vertices = static_cast<double>(made.final.size());
  } else {
    const DistributedMesh made = distributed_mesh(MPI_COMM_WORLD, background, torus, params);
    row.n_tets = static_cast<double>(made.mesh.C.size());
    row.n_vertices = static_cast<double>(made.mesh.V.size());
    row.messages = static_cast<double>(made.traffic.messages);
    row.bytes = static_cast<double>(made.traffic.bytes);
    row.exchanges = static_cast<double>(made.traffic.exchanges);
    row.reductions = static_cast<double>(made.traffic.reductions);
    row.gets = static_cast<double>(made.n_gets);
    row.bytes_got = static_cast<double>(made.bytes_got);
  }
  row.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  row.peak_MB = peak_MB(&row.cpu);
  constexpr int kNumbers = sizeof(Row) / sizeof(double);
  std::vector<Row> rows(static_cast<std::size_t>(n_ranks));
  MPI_Gather(&row, kNumbers, MPI_DOUBLE, rows.data(), kNumbers, MPI_DOUBLE, 0, MPI_COMM_WORLD);
  if (rank == 0) {
    std::printf(
        "rank tets vertices wall_s cpu_s peak_MB before_MB messages MB_sent exchanges reductions gets MB_got\n");
    for (int r = 0; r < n_ranks; ++r) {
      const Row& o = rows[static_cast<std::size_t>(r)];
      std::printf("%d %.0f %.0f %.2f %.2f %.0f %.0f %.0f %.2f %.0f %.0f %.0f %.2f\n", r, o.n_tets, o.n_vertices,
                  o.seconds, o.cpu, o.peak_MB, o.before_MB, o.messages, o.bytes / 1e6, o.exchanges, o.reductions,
                  o.gets, o.bytes_got / 1e6);
    }
  }
  MPI_Finalize();
}
