#include "pipeline/domain/background_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <string>

#include "mesh/background/a15_box.h"
#include "mesh/io/tet_mesh_io.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/memory.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

BackgroundMesh read_background(const fs::path& file, const Vec3& shift) {
  TetMesh mesh = read_tet_mesh(file).mesh;
  for (Vec3& x : mesh.V) x -= shift;
  try {
    return BackgroundMesh(std::move(mesh));
  } catch (const std::invalid_argument& e) {
    throw MeshFileRefused(file, "as a background mesh", e.what());
  }
}

}  // namespace

std::optional<fs::path> background_file(const Parameters& parameters) {
  const std::string& name = parameters.mesh().background;
  const auto names = tiling_names();
  if (std::find(names.begin(), names.end(), name) != names.end()) return std::nullopt;
  return name;
}

void require_walls(const Parameters& parameters) {
  const bool walls = parameters.mesh().box_walls;
  if (walls && parameters.mesh().background != "a15") throw UsageError("--box-walls is for --background a15");
  if (walls || !parameters.mesh().complement) return;
  throw UsageError("--complement needs --box-walls: what is around the body ends at the flat walls of --box");
}

ClassificationSource classification_source(const Parameters& parameters) {
  const bool chosen =
      parameters.mesh().mode == MeshingMode::Fast && !parameters.mesh().box_walls && !background_file(parameters);
  return chosen ? ClassificationSource::Chosen : ClassificationSource::Psi;
}

BackgroundChoice::BackgroundChoice(const Parameters& parameters, const Domain& domain)
    : tiling_(&a15()), source_(classification_source(parameters)), walls_(parameters.mesh().box_walls) {
  require_walls(parameters);
  const std::optional<fs::path> file = background_file(parameters);
  if (!file) tiling_ = &tiling_named(parameters.mesh().background);
  if (!file) return;
  if (parameters.mesh().h > 0 || parameters.mesh().tets > 0) {
    throw UsageError("--h and --tets: " + file->string() + " has its own edge lengths");
  }
  given_.emplace(read_background(*file, domain.shift));
}

double BackgroundChoice::expected_tets(const Domain& domain, double h) const {
  return umtet::expected_tets(*tiling_, domain.size(), h, source_);
}

BackgroundMesh BackgroundChoice::make(const Domain& domain, double h, std::int64_t n_tets, double allowed) const {
  const auto expected = [&](const BackgroundMesh& background) {
    const double n = n_tets > 0 ? static_cast<double>(n_tets) : expected_tets(domain, h);
    return std::min(n, static_cast<double>(background.n_tets()));
  };
  try {
    BackgroundMesh background = given_   ? *given_
                                : walls_ ? BackgroundMesh(a15_box(domain.box, h))
                                         : BackgroundMesh(*tiling_, domain.box, h);
    require_memory(background, expected(background), allowed);
    return background;
  } catch (const std::invalid_argument& e) {  // h and the box have been checked: their tets are too many to count
    throw ResourceLimit(fmt::format("h = {:.4g}: no background mesh: {}", h, e.what()));
  }
}

}  // namespace umtet
