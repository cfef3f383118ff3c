// Preloaded into the program under test: the n-th call of one kind fails.
//
//   UMTET_FAULT=malloc|open|write|fsync|rename|close   the kind
//   UMTET_FAULT_AT=n                                  the first call that fails, from 1
//   UMTET_FAULT_FOR=m                                 how many fail from there on (default 1)
//   UMTET_FAULT_UNDER=/folder                         for all kinds but malloc: only files below it count
//   UMTET_FAULT_COUNT=/file                           where the number of calls is left at the end
//
// Allocations count from the first line of main(), those of at least UMTET_FAULT_BYTES (default 1) bytes.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

static atomic_long n_calls;
static long first = -1, how_many = 1, least_bytes = 1;
static const char *kind = "", *under = "", *count_file = NULL;
static atomic_int armed;

static int fails(void) {
  const long n = atomic_fetch_add(&n_calls, 1) + 1;
  return first > 0 && n >= first && n < first + how_many;
}

static int is_kind(const char* name) { return atomic_load(&armed) && strcmp(kind, name) == 0; }
static int is_below(const char* path) { return *under && strncmp(path, under, strlen(under)) == 0; }

static int is_file_below(int fd) {
  char link[64], path[4096];
  snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  const ssize_t n = readlink(link, path, sizeof path - 1);
  if (n <= 0) return 0;
  path[n] = 0;
  return is_below(path);
}

static long number(const char* name, long preset) {
  const char* text = getenv(name);
  return text ? atol(text) : preset;
}

static int (*program)(int, char**, char**);
static int armed_main(int argc, char** argv, char** environment) {
  atomic_store(&armed, 1);
  return program(argc, argv, environment);
}

// The start-up code hands main() to this function. What libraries allocate before, when they are loaded, is not ours.
int __libc_start_main(int (*main)(int, char**, char**), int argc, char** argv, void (*init)(void), void (*fini)(void),
                      void (*end)(void), void* stack) {
  int (*next)(int (*)(int, char**, char**), int, char**, void (*)(void), void (*)(void), void (*)(void), void*) =
      dlsym(RTLD_NEXT, "__libc_start_main");
  first = number("UMTET_FAULT_AT", -1);
  how_many = number("UMTET_FAULT_FOR", 1);
  least_bytes = number("UMTET_FAULT_BYTES", 1);
  count_file = getenv("UMTET_FAULT_COUNT");
  if (getenv("UMTET_FAULT_UNDER")) under = getenv("UMTET_FAULT_UNDER");
  if (getenv("UMTET_FAULT")) kind = getenv("UMTET_FAULT");
  program = main;
  return next(armed_main, argc, argv, init, fini, end, stack);
}

__attribute__((destructor)) static void leave_count(void) {
  atomic_store(&armed, 0);
  if (!count_file) return;
  FILE* out = fopen(count_file, "w");
  if (!out) return;
  fprintf(out, "%ld\n", atomic_load(&n_calls));
  fclose(out);
}

extern void* __libc_malloc(size_t);
extern void* __libc_calloc(size_t, size_t);
extern void* __libc_realloc(void*, size_t);
extern void* __libc_memalign(size_t, size_t);

static int refused(size_t bytes) {
  if (!is_kind("malloc") || bytes < (size_t)least_bytes || !fails()) return 0;
  errno = ENOMEM;
  return 1;
}

void* malloc(size_t n) { return refused(n) ? NULL : __libc_malloc(n); }
void* calloc(size_t n, size_t size) { return refused(n * size) ? NULL : __libc_calloc(n, size); }
void* realloc(void* p, size_t n) { return n > 0 && refused(n) ? NULL : __libc_realloc(p, n); }
void* aligned_alloc(size_t a, size_t n) { return refused(n) ? NULL : __libc_memalign(a, n); }
int posix_memalign(void** p, size_t a, size_t n) {
  if (refused(n)) return ENOMEM;
  *p = __libc_memalign(a, n);
  return *p ? 0 : ENOMEM;
}

#define NEXT(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

static int opened(int (*next)(const char*, int, ...), const char* path, int flags, mode_t mode) {
  if (is_kind("open") && is_below(path) && fails()) {
    errno = EMFILE;
    return -1;
  }
  return next(path, flags, mode);
}
static mode_t mode_of(int flags, va_list list) { return flags & (O_CREAT | __O_TMPFILE) ? va_arg(list, mode_t) : 0; }

int open(const char* path, int flags, ...) {
  va_list list;
  va_start(list, flags);
  const mode_t mode = mode_of(flags, list);
  va_end(list);
  return opened(NEXT(open), path, flags, mode);
}
int open64(const char* path, int flags, ...) {
  va_list list;
  va_start(list, flags);
  const mode_t mode = mode_of(flags, list);
  va_end(list);
  return opened(NEXT(open64), path, flags, mode);
}
// stdio opens inside libc, past open(): streams of C++ and FILE come this way.
FILE* fopen(const char* path, const char* mode) {
  if (is_kind("open") && is_below(path) && fails()) {
    errno = EMFILE;
    return NULL;
  }
  return NEXT(fopen)(path, mode);
}
FILE* fopen64(const char* path, const char* mode) {
  if (is_kind("open") && is_below(path) && fails()) {
    errno = EMFILE;
    return NULL;
  }
  return NEXT(fopen64)(path, mode);
}
size_t fwrite(const void* data, size_t size, size_t n, FILE* file) {
  if (is_kind("write") && is_file_below(fileno(file)) && fails()) {
    errno = ENOSPC;
    return 0;
  }
  return NEXT(fwrite)(data, size, n, file);
}
int fclose(FILE* file) {
  const int fail = is_kind("close") && is_file_below(fileno(file)) && fails();
  const int result = NEXT(fclose)(file);
  if (!fail) return result;
  errno = EIO;
  return EOF;
}

ssize_t write(int fd, const void* data, size_t n) {
  if (is_kind("write") && is_file_below(fd) && fails()) {
    errno = ENOSPC;
    return -1;
  }
  return NEXT(write)(fd, data, n);
}
#include <sys/uio.h>
ssize_t writev(int fd, const struct iovec* data, int n) {
  if (is_kind("write") && is_file_below(fd) && fails()) {
    errno = ENOSPC;
    return -1;
  }
  return NEXT(writev)(fd, data, n);
}
int fsync(int fd) {
  if (is_kind("fsync") && is_file_below(fd) && fails()) {
    errno = EIO;
    return -1;
  }
  return NEXT(fsync)(fd);
}
int close(int fd) {
  const int fail = is_kind("close") && is_file_below(fd) && fails();
  const int result = NEXT(close)(fd);
  if (!fail) return result;
  errno = EIO;
  return -1;
}
int rename(const char* from, const char* to) {
  if (is_kind("rename") && is_below(to) && fails()) {
    errno = EACCES;
    return -1;
  }
  return NEXT(rename)(from, to);
}
