#include "pipeline/meshing/part_mesher.h"

#include "mesh/classification/configuration_costs.h"
#include "body/sizing/background_choice.h"
#include "body/sizing/graded_sizes.h"

namespace umtet {

std::string for_one_process(const Parameters& parameters) {
  const MeshParameters& mesh = parameters.mesh();
  if (mesh.mode != MeshingMode::Fast) return "--mode paper";
  if (mesh.box_walls || mesh.complement) return "a mesh with walls";
  if (mesh.keep_iterates) return "--keep-iterates";
  if (background_file(parameters) || is_graded(parameters)) return "a background that is no lattice";
  if (!configuration_costs(tiling_of(parameters))) return "a background whose tiling has no costs";
  return "";
}

}  // namespace umtet
