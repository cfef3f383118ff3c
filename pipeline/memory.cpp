#include "pipeline/memory.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

#include "pipeline/exit_code.h"

namespace umtet {
namespace {

// Peak of the whole run over its tets: 133 MB for a ball of 300 000, and 1 GB for two million.
constexpr double kBytesPerTet = 500;
// The searches for omega_h keep up to four bits per vertex of the background mesh, with ranks, and two per tet.
constexpr double kBytesPerBackgroundVertex = 1, kBytesPerBackgroundTet = .25;

/// What the system says it can give without swapping; infinite where it does not say.
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
  const double asked = 1e9 * parameters.real("output.max_memory");
  return asked > 0 ? asked : available_bytes();
}

void require_memory(const BackgroundMesh& background, double n_tets, double allowed) {
  const double need = kBytesPerTet * n_tets + kBytesPerBackgroundVertex * static_cast<double>(background.n_vertices()) +
                      kBytesPerBackgroundTet * static_cast<double>(background.n_tets());
  if (need <= allowed) return;
  throw ResourceLimit(fmt::format(
      "h = {:.4g}: about {:.3g} tets in a background mesh of {:.3g} need {:.3g} GB of memory, and {:.3g} GB are "
      "allowed: fewer --tets or a larger --h{}",
      background.h(), n_tets, static_cast<double>(background.n_tets()), need / 1e9, allowed / 1e9,
      n_tets < .01 * static_cast<double>(background.n_tets()) ? ", or a --box closer around the domain" : ""));
}

}  // namespace umtet
