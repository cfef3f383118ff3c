#include "pipeline/case/memory.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include "body/option_names.h"
#include "pipeline/case/exit_code.h"

namespace umtet {
namespace {

// mesh.vtu of a ball: 4.3 MB for 98 thousand tets, 44 bytes a tet.
constexpr double kFileBytesPerTet = 45;
// Default stack size of a thread in glibc and TBB.
constexpr double kStackBytes = 8 << 20;
// AddressSanitizer's allocator ends the process if the system refuses memory; requests that are checked beforehand
// (require_memory) are refused with it, too.
#ifdef __SANITIZE_ADDRESS__
constexpr bool kAllocationsMayFail = false;
#else
constexpr bool kAllocationsMayFail = true;
#endif

/// Returns the bytes that the process has mapped for writing; 0 if the system does not report them.
double data_bytes() {
  std::ifstream in("/proc/self/status");
  std::string line;
  while (std::getline(in, line)) {
    if (line.starts_with("VmData:")) return 1024 * std::strtod(line.c_str() + 7, nullptr);
  }
  return 0;
}

/// Returns the bytes that the system can provide without swapping; infinity if it does not report them.
double available_bytes() {
  double least = std::numeric_limits<double>::infinity();
  std::ifstream in("/proc/meminfo");
  std::string key, unit;
  double kib = 0;
  while (in >> key >> kib) {
    if (key == "MemAvailable:") least = 1024 * kib;
    std::getline(in, unit);
  }
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY) {
    least = std::min(least, static_cast<double>(limit.rlim_cur));
  }
  return least;
}

}  // namespace

double allowed_bytes(const Parameters& parameters) {
  const double asked = 1e9 * parameters.output().max_memory;
  return asked > 0 ? asked : available_bytes();
}

void limit_memory(double bytes, int threads) {
  rlimit limit{};
  if (!kAllocationsMayFail || ::getrlimit(RLIMIT_DATA, &limit) != 0) return;
  const double most = data_bytes() + bytes + threads * kStackBytes;
  if (most >= static_cast<double>(limit.rlim_cur)) return;
  limit.rlim_cur = static_cast<rlim_t>(most);
  ::setrlimit(RLIMIT_DATA, &limit);
}

void require_disk(const std::filesystem::path& folder, double n_tets) {
  std::error_code unknown;
  const std::filesystem::space_info space = std::filesystem::space(folder, unknown);
  const double need = kFileBytesPerTet * n_tets;
  if (unknown || need <= static_cast<double>(space.available)) return;
  throw ResourceLimit(
      fmt::format("{}: the meshes need about {:.3g} GB of disk, and {:.3g} GB are free: free disk space",
                  folder.string(), need / 1e9, static_cast<double>(space.available) / 1e9),
      {{Change::Lower, option::tets}, {Change::Raise, option::h}});
}

}  // namespace umtet
