// Preloaded into umtet_mpi: what each rank takes and sends, by phase. MPI's profiling interface counts; MPI_Pcontrol(1,
// NAME) begins a phase (distributed/exchange/phase.h).
//
//   UMTET_TRAFFIC=/file      of each rank, with .r behind it: a line for each phase
//
//     phase cpu_s cpu_in_mpi_s collectives exchanges messages bytes_sent gets bytes_got bytes_written peak_bytes
//
// The peak is that of the process at the end of the phase. Collectives are calls for all ranks, exchanges those for
// neighbours. `cpu_s` does not contain the time in MPI, where a rank waits. Bytes of a collective are what this rank
// puts into it.
#define _GNU_SOURCE
#include <mpi.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>

struct Row {
  char name[40];
  double cpu, cpu_in_mpi;
  long collectives, exchanges, messages, sent, gets, got, written, peak;
};

static struct Row rows[64];
static int n_rows = 0;
static struct Row* row = rows;
static double cpu_before;

static double cpu_seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void end_phase(void) {
  const double cpu = cpu_seconds();
  struct rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  if (n_rows > 0) {
    row->cpu += cpu - cpu_before;
    row->peak = 1024 * usage.ru_maxrss;
  }
  cpu_before = cpu;
}

static void begin_phase(const char* name) {
  end_phase();
  int k = 0;
  while (k < n_rows && strcmp(rows[k].name, name) != 0) ++k;
  if (k == n_rows) {
    if (n_rows == (int)(sizeof rows / sizeof *rows)) abort();
    snprintf(rows[k].name, sizeof rows[k].name, "%s", name);
    ++n_rows;
  }
  row = rows + k;
}

int MPI_Pcontrol(const int level, ...) {
  va_list list;
  va_start(list, level);
  if (level == 1) begin_phase(va_arg(list, const char*));
  va_end(list);
  return MPI_SUCCESS;
}

int MPI_Init_thread(int* argc, char*** argv, int asked, int* given) {
  const int result = PMPI_Init_thread(argc, argv, asked, given);
  begin_phase("start");
  return result;
}

int MPI_Finalize(void) {
  end_phase();
  const char* file = getenv("UMTET_TRAFFIC");
  int rank = 0;
  PMPI_Comm_rank(MPI_COMM_WORLD, &rank);
  char path[4096];
  snprintf(path, sizeof path, "%s.%d", file ? file : "traffic", rank);
  FILE* out = fopen(path, "w");
  if (!out) abort();
  for (const struct Row* r = rows; r < rows + n_rows; ++r) {
    fprintf(out, "%s %.6f %.6f %ld %ld %ld %ld %ld %ld %ld %ld\n", r->name, r->cpu - r->cpu_in_mpi, r->cpu_in_mpi,
            r->collectives, r->exchanges, r->messages, r->sent, r->gets, r->got, r->written, r->peak);
  }
  fclose(out);
  return PMPI_Finalize();
}

static long bytes_of(long n, MPI_Datatype type) {
  int size = 0;
  PMPI_Type_size(type, &size);
  return n * size;
}

static int n_in(MPI_Comm comm) {
  int n = 1;
  PMPI_Comm_size(comm, &n);
  return n;
}

/// What this rank puts into a collective; to itself it sends nothing.
static void count_collective(long bytes) {
  ++row->collectives;
  row->sent += bytes;
}

static void count_messages(const int* counts, int n, int self, MPI_Datatype type) {
  for (int k = 0; k < n; ++k) {
    if (k == self || counts[k] == 0) continue;
    ++row->messages;
    row->sent += bytes_of(counts[k], type);
  }
}

static int rank_in(MPI_Comm comm) {
  int rank = 0;
  PMPI_Comm_rank(comm, &rank);
  return rank;
}

#define TIMED(name, types, values, count)      \
  int MPI_##name types {                       \
    count;                                     \
    const double before = cpu_seconds();       \
    const int result = PMPI_##name values;     \
    row->cpu_in_mpi += cpu_seconds() - before; \
    return result;                             \
  }

TIMED(Allreduce, (const void* a, void* b, int n, MPI_Datatype t, MPI_Op o, MPI_Comm c), (a, b, n, t, o, c),
      count_collective(bytes_of(n, t)))
TIMED(Reduce, (const void* a, void* b, int n, MPI_Datatype t, MPI_Op o, int r, MPI_Comm c), (a, b, n, t, o, r, c),
      count_collective(bytes_of(n, t)))
TIMED(Exscan, (const void* a, void* b, int n, MPI_Datatype t, MPI_Op o, MPI_Comm c), (a, b, n, t, o, c),
      count_collective(bytes_of(n, t)))
TIMED(Bcast, (void* a, int n, MPI_Datatype t, int r, MPI_Comm c), (a, n, t, r, c),
      count_collective(rank_in(c) == r ? bytes_of(n, t) : 0))
TIMED(Ibcast, (void* a, int n, MPI_Datatype t, int r, MPI_Comm c, MPI_Request* q), (a, n, t, r, c, q),
      count_collective(rank_in(c) == r ? bytes_of(n, t) : 0))
TIMED(Test, (MPI_Request * q, int* f, MPI_Status* s), (q, f, s), )
TIMED(Barrier, (MPI_Comm c), (c), count_collective(0))
TIMED(Gather, (const void* a, int n, MPI_Datatype t, void* b, int m, MPI_Datatype u, int r, MPI_Comm c),
      (a, n, t, b, m, u, r, c), count_collective(rank_in(c) == r ? 0 : bytes_of(n, t)))
TIMED(Gatherv,
      (const void* a, int n, MPI_Datatype t, void* b, const int* m, const int* d, MPI_Datatype u, int r, MPI_Comm c),
      (a, n, t, b, m, d, u, r, c), count_collective(rank_in(c) == r ? 0 : bytes_of(n, t)))
TIMED(Allgather, (const void* a, int n, MPI_Datatype t, void* b, int m, MPI_Datatype u, MPI_Comm c),
      (a, n, t, b, m, u, c), count_collective(bytes_of(n, t)))
TIMED(Alltoall, (const void* a, int n, MPI_Datatype t, void* b, int m, MPI_Datatype u, MPI_Comm c),
      (a, n, t, b, m, u, c), count_collective(bytes_of((long)n*(n_in(c) - 1), t)))
TIMED(Alltoallv,
      (const void* a, const int* n, const int* d, MPI_Datatype t, void* b, const int* m, const int* e, MPI_Datatype u,
       MPI_Comm c),
      (a, n, d, t, b, m, e, u, c), ++row->collectives;
      count_messages(n, n_in(c), rank_in(c), t))
TIMED(Send, (const void* a, int n, MPI_Datatype t, int r, int g, MPI_Comm c), (a, n, t, r, g, c), ++row->messages;
      row->sent += bytes_of(n, t))
TIMED(Isend, (const void* a, int n, MPI_Datatype t, int r, int g, MPI_Comm c, MPI_Request* q), (a, n, t, r, g, c, q),
      ++row->messages;
      row->sent += bytes_of(n, t))
TIMED(Recv, (void* a, int n, MPI_Datatype t, int r, int g, MPI_Comm c, MPI_Status* s), (a, n, t, r, g, c, s), )
TIMED(Wait, (MPI_Request * q, MPI_Status* s), (q, s), )
TIMED(Waitall, (int n, MPI_Request* q, MPI_Status* s), (n, q, s), )
TIMED(Sendrecv,
      (const void* a, int n, MPI_Datatype t, int r, int g, void* b, int m, MPI_Datatype u, int p, int h, MPI_Comm c,
       MPI_Status* s),
      (a, n, t, r, g, b, m, u, p, h, c, s), ++row->messages;
      row->sent += bytes_of(n, t))
TIMED(Get, (void* a, int n, MPI_Datatype t, int r, MPI_Aint d, int m, MPI_Datatype u, MPI_Win w),
      (a, n, t, r, d, m, u, w), ++row->gets;
      row->got += bytes_of(n, t))
TIMED(Win_flush_all, (MPI_Win w), (w), )
TIMED(Win_unlock_all, (MPI_Win w), (w), )
TIMED(Win_free, (MPI_Win * w), (w), count_collective(0))
TIMED(Win_allocate, (MPI_Aint n, int d, MPI_Info i, MPI_Comm c, void* p, MPI_Win* w), (n, d, i, c, p, w),
      count_collective(0))
TIMED(File_open, (MPI_Comm c, const char* f, int m, MPI_Info i, MPI_File* h), (c, f, m, i, h), count_collective(0))
TIMED(File_write_at, (MPI_File h, MPI_Offset o, const void* a, int n, MPI_Datatype t, MPI_Status* s),
      (h, o, a, n, t, s), row->written += bytes_of(n, t))
TIMED(File_set_size, (MPI_File h, MPI_Offset n), (h, n), count_collective(0))
TIMED(File_sync, (MPI_File h), (h), count_collective(0))
TIMED(File_close, (MPI_File * h), (h), count_collective(0))

static int n_neighbours(MPI_Comm comm) {
  int in = 0, out = 0, weighted = 0;
  PMPI_Dist_graph_neighbors_count(comm, &in, &out, &weighted);
  return out;
}
TIMED(Neighbor_alltoall, (const void* a, int n, MPI_Datatype t, void* b, int m, MPI_Datatype u, MPI_Comm c),
      (a, n, t, b, m, u, c), ++row->exchanges;
      row->messages += n_neighbours(c); row->sent += bytes_of((long)n * n_neighbours(c), t))
TIMED(Neighbor_alltoallv,
      (const void* a, const int* n, const int* d, MPI_Datatype t, void* b, const int* m, const int* e, MPI_Datatype u,
       MPI_Comm c),
      (a, n, d, t, b, m, e, u, c), ++row->exchanges;
      count_messages(n, n_neighbours(c), -1, t))
