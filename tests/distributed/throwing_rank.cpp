// A program of which rank 0 throws while the others wait for it, for faults_test.py: all have to end with its reason.
//
//   throwing_rank window       psi throws while states and places are open to all
//   throwing_rank file FILE    what fills a file of all ranks throws

#include <mpi.h>

#include <atomic>
#include <new>
#include <stdexcept>
#include <string_view>

#include "distributed/exchange/collect.h"
#include "distributed/io/shared_file.h"
#include "distributed/mesh/distributed_mesh.h"
#include "distributed/program/together.h"
#include "pipeline/case/interrupt.h"
#include "tests/support/domains.h"

namespace {

std::atomic<int> n_open = 0;  // windows

}  // namespace

// In the place of MPI's own functions.
extern "C" int MPI_Win_lock_all(int what, MPI_Win window) {
  ++n_open;
  return PMPI_Win_lock_all(what, window);
}
extern "C" int MPI_Win_unlock_all(MPI_Win window) {
  --n_open;
  return PMPI_Win_unlock_all(window);
}

namespace umtet {
namespace {

/// A body with parts so thin that there is something to repair.
/// @param windows  psi throws while some are open; null: it never does
testing::AnalyticDomain body(const std::atomic<int>* windows) {
  testing::AnalyticDomain domain;
  domain.psi = [windows](const Vec3& x, Vec3* g, Mat3* H) {
    if (windows && *windows > 0) throw std::runtime_error("psi throws beside an open window");
    const Vec3 square = x.cwiseProduct(x);
    if (g) *g = 4 * square.cwiseProduct(x) - 2.4 * x;
    if (H) *H = (12 * square - Vec3::Constant(2.4)).asDiagonal();
    return square.squaredNorm() - 1.2 * x.squaredNorm() + .6;
  };
  return domain;
}

constexpr double kH = .06;
const Box kBox(Vec3::Constant(-1.5), Vec3::Constant(1.5));

void throw_beside_window(MPI_Comm comm) {
  const testing::AnalyticDomain domain = body(rank_in(comm) == 0 ? &n_open : nullptr);
  together(comm, [&] { distributed_mesh(comm, {a15(), kBox, kH}, domain); });
}

void throw_beside_file(MPI_Comm comm, const char* path) {
  together(comm, [&] {
    SharedFile file(comm, path);
    if (rank_in(comm) == 0) throw std::bad_alloc();
    file.close(0);
  });
}

}  // namespace
}  // namespace umtet

int main(int argc, char** argv) {
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  umtet::set_work_at_hand("mesh");
  const std::string_view what = argv[1];
  if (what == "window") umtet::throw_beside_window(MPI_COMM_WORLD);
  if (what == "file") umtet::throw_beside_file(MPI_COMM_WORLD, argv[2]);
  MPI_Finalize();
  return 0;
}
