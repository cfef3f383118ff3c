// Drives a fuzz target without libFuzzer: every seed, then mutations of it, the same at every call.
//   fuzz_NAME [FOLDER MUTATIONS] ...    seeds, and so many mutations of each
//   fuzz_NAME FILE ...                  these inputs only, to look at a finding
// An input that crashes the target, or takes too long, is written to crash-NAME in the current folder.

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
// Sanitizers end by abort(), which the handler below sees.
extern "C" const char* __asan_default_options() { return "abort_on_error=1:detect_leaks=0"; }
extern "C" const char* __ubsan_default_options() { return "abort_on_error=1"; }

namespace {

namespace fs = std::filesystem;

// What a reader may take for an input of some kilobytes: seconds of CPU (a sanitizer costs a factor of ten), and
// bytes of address space where no sanitizer needs it.
#ifdef __SANITIZE_ADDRESS__
constexpr double kSeconds = 10;
#else
constexpr double kSeconds = 1;
constexpr rlim_t kAddressSpace = rlim_t{2} << 30;
#endif

std::string input;       ///< of the running call
std::string crash_file;  ///< where the handler writes it

void save_input(int signal) {
  if (const int fd = ::open(crash_file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644); fd >= 0) {
    if (::write(fd, input.data(), input.size()) < 0) std::perror(crash_file.c_str());
    ::close(fd);
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void run() {
  const std::clock_t begin = std::clock();
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
  const double seconds = static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
  if (seconds < kSeconds) return;
  std::fprintf(stderr, "an input of %zu bytes takes %.1f s of CPU\n", input.size(), seconds);
  std::abort();
}

std::string content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// Numbers at which counts wrap, change sign or are none.
const char* const kNumbers[] = {"0",  "-1",  "1",    "255",  "2147483647", "4294967295", "18446744073709551615",
                                "99", "nan", "-inf", "1e99", "1e-320",     "0x7f",       "768614336404564651"};

/// Some bytes of `bytes` changed, repeated, cut or put in; a run of digits replaced.
void mutate(std::string& bytes, std::mt19937& random) {
  const auto below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
  for (int hit = 0, n = 1 + static_cast<int>(random() % 3); hit < n; ++hit) {
    // Most of the structure is in front.
    const std::size_t at = below(random() % 2 ? bytes.size() : std::min<std::size_t>(300, bytes.size()));
    switch (random() % 6) {
      case 0:
        if (!bytes.empty()) bytes[at] = static_cast<char>(random());
        break;
      case 1:
        if (!bytes.empty()) bytes[at] = static_cast<char>(bytes[at] ^ (1 << random() % 8));
        break;
      case 2:
        bytes.erase(at, below(32));
        break;
      case 3:
        bytes.insert(at, bytes.substr(at, below(64)));
        break;
      case 4:
        if (random() % 4 == 0) bytes.resize(at);
        break;
      default: {
        const std::size_t begin = bytes.find_first_of("0123456789", at);
        if (begin == std::string::npos) break;
        const std::size_t end = std::min(bytes.find_first_not_of("0123456789", begin), bytes.size());
        bytes.replace(begin, end - begin, kNumbers[below(std::size(kNumbers))]);
      }
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
#ifndef __SANITIZE_ADDRESS__
  const rlimit limit{kAddressSpace, kAddressSpace};
  ::setrlimit(RLIMIT_AS, &limit);
#endif
  crash_file = "crash-" + fs::path(argv[0]).filename().string();
  for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE}) std::signal(signal, save_input);
  if (argc % 2 == 0 || !fs::is_directory(argv[1])) {
    for (int i = 1; i < argc; ++i) {
      input = content(argv[i]);
      run();
    }
    return 0;
  }
  for (int i = 1; i < argc; i += 2) {
    std::vector<fs::path> seeds{fs::directory_iterator(argv[i]), {}};
    std::sort(seeds.begin(), seeds.end());
    if (seeds.empty()) return std::fprintf(stderr, "%s: no seeds\n", argv[i]), 1;
    const int n_mutations = std::atoi(argv[i + 1]);
    for (const fs::path& seed : seeds) {
      const std::string bytes = content(seed);
      std::mt19937 random(1);
      for (int k = 0; k <= n_mutations; ++k) {
        input = bytes;
        if (k > 0) mutate(input, random);
        run();
      }
    }
    std::printf("%zu seeds, %d mutations of each\n", seeds.size(), n_mutations);
  }
}
