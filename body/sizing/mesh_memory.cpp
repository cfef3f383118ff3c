#include "body/sizing/mesh_memory.h"

#include <vector>

#include "body/errors.h"
#include "body/option_names.h"
#include "common/formatted.h"

namespace umtet {
namespace {

// Peak of a whole run over its tets, about.
constexpr double kBytesPerTet = 500;
// The searches for omega_h keep up to four bits per vertex of the background mesh, with ranks, and two per tet.
constexpr double kBytesPerBackgroundVertex = 1, kBytesPerBackgroundTet = .25;

}  // namespace

void require_memory(const BackgroundMesh& background, double n_tets, double allowed) {
  const double need = kBytesPerTet * n_tets + kBytesPerBackgroundVertex * static_cast<double>(background.n_vertices()) +
                      kBytesPerBackgroundTet * static_cast<double>(background.n_tets());
  if (need <= allowed) return;
  std::vector<Remedy> remedies = {{Change::Lower, option::tets}, {Change::Raise, option::h}};
  if (n_tets < .01 * static_cast<double>(background.n_tets()))
    remedies.push_back({Change::Give, option::box, "closer around the domain"});
  throw ResourceLimit(
      formatted(
          "h = %.4g: about %.3g tets in a background mesh of %.3g need %.3g GB of memory, and %.3g GB are allowed",
          background.h(), n_tets, static_cast<double>(background.n_tets()), need / 1e9, allowed / 1e9),
      remedies);
}

}  // namespace umtet
