// Preloaded into umtet_mpi: one rank sends itself a signal when it begins its n-th step, that of kill -9 if none is
// named. Steps are calls of MPI that wait for others, and what puts files of a case into their places. The same run has
// the same steps.
//
//   UMTET_KILL_RANK=r        the rank
//   UMTET_KILL_AT=n          its step, from 1; none: it lives
//   UMTET_KILL_STEP=rename   of steps with this name alone
//   UMTET_KILL_SIGNAL=n      the signal
//   UMTET_KILL_LOG=/file     of each rank, with .r behind it: how many steps there were; of one that was killed the
//                            name of its last, and the time
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <mpi.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

static long n_steps;

static long number(const char* name, long preset) {
  const char* text = getenv(name);
  return text ? atol(text) : preset;
}

static void log_step(const char* step) {
  const char* file = getenv("UMTET_KILL_LOG");
  if (!file) return;
  char path[4096], text[200];
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  snprintf(path, sizeof path, "%s.%ld", file, number("OMPI_COMM_WORLD_RANK", 0));
  const int n = snprintf(text, sizeof text, "%ld %s %ld.%09ld\n", n_steps, step, (long)now.tv_sec, now.tv_nsec);
  const int out = open(path, O_WRONLY | O_CREAT | O_TRUNC, 0666);
  if (out < 0) return;
  if (write(out, text, (size_t)n) != n) abort();
  close(out);
}

static void step(const char* name) {
  // Libraries call from threads of their own; those that are counted come from the thread of main().
  if (syscall(SYS_gettid) != getpid()) return;
  const char* wanted = getenv("UMTET_KILL_STEP");
  if (wanted && strcmp(wanted, name) != 0) return;
  ++n_steps;
  if (n_steps != number("UMTET_KILL_AT", -1) || number("OMPI_COMM_WORLD_RANK", 0) != number("UMTET_KILL_RANK", -1))
    return;
  log_step(name);
  raise((int)number("UMTET_KILL_SIGNAL", SIGKILL));
}

#define STEP(name, types, values) \
  int MPI_##name types {          \
    step(#name);                  \
    return PMPI_##name values;    \
  }

STEP(Allreduce, (const void* a, void* b, int n, MPI_Datatype t, MPI_Op o, MPI_Comm c), (a, b, n, t, o, c))
STEP(Reduce, (const void* a, void* b, int n, MPI_Datatype t, MPI_Op o, int r, MPI_Comm c), (a, b, n, t, o, r, c))
STEP(Exscan, (const void* a, void* b, int n, MPI_Datatype t, MPI_Op o, MPI_Comm c), (a, b, n, t, o, c))
STEP(Bcast, (void* a, int n, MPI_Datatype t, int r, MPI_Comm c), (a, n, t, r, c))
STEP(Ibcast, (void* a, int n, MPI_Datatype t, int r, MPI_Comm c, MPI_Request* q), (a, n, t, r, c, q))
STEP(Barrier, (MPI_Comm c), (c))
STEP(Gather, (const void* a, int n, MPI_Datatype t, void* b, int m, MPI_Datatype u, int r, MPI_Comm c),
     (a, n, t, b, m, u, r, c))
STEP(Gatherv,
     (const void* a, int n, MPI_Datatype t, void* b, const int* m, const int* d, MPI_Datatype u, int r, MPI_Comm c),
     (a, n, t, b, m, d, u, r, c))
STEP(Allgather, (const void* a, int n, MPI_Datatype t, void* b, int m, MPI_Datatype u, MPI_Comm c),
     (a, n, t, b, m, u, c))
STEP(Alltoall, (const void* a, int n, MPI_Datatype t, void* b, int m, MPI_Datatype u, MPI_Comm c),
     (a, n, t, b, m, u, c))
STEP(Alltoallv,
     (const void* a, const int* n, const int* d, MPI_Datatype t, void* b, const int* m, const int* e, MPI_Datatype u,
      MPI_Comm c),
     (a, n, d, t, b, m, e, u, c))
STEP(Neighbor_alltoall, (const void* a, int n, MPI_Datatype t, void* b, int m, MPI_Datatype u, MPI_Comm c),
     (a, n, t, b, m, u, c))
STEP(Neighbor_alltoallv,
     (const void* a, const int* n, const int* d, MPI_Datatype t, void* b, const int* m, const int* e, MPI_Datatype u,
      MPI_Comm c),
     (a, n, d, t, b, m, e, u, c))
STEP(Send, (const void* a, int n, MPI_Datatype t, int r, int g, MPI_Comm c), (a, n, t, r, g, c))
STEP(Recv, (void* a, int n, MPI_Datatype t, int r, int g, MPI_Comm c, MPI_Status* s), (a, n, t, r, g, c, s))
STEP(Waitall, (int n, MPI_Request* q, MPI_Status* s), (n, q, s))
STEP(Win_flush_all, (MPI_Win w), (w))
STEP(File_open, (MPI_Comm c, const char* f, int m, MPI_Info i, MPI_File* h), (c, f, m, i, h))
STEP(File_write_at, (MPI_File h, MPI_Offset o, const void* a, int n, MPI_Datatype t, MPI_Status* s), (h, o, a, n, t, s))
STEP(File_sync, (MPI_File h), (h))
STEP(File_close, (MPI_File * h), (h))

int rename(const char* from, const char* to) {
  step("rename");
  return ((__typeof__(&rename))dlsym(RTLD_NEXT, "rename"))(from, to);
}

int MPI_Finalize(void) {
  log_step("end");  // what other ranks do is done, too
  return PMPI_Finalize();
}
