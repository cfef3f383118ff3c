#include "pipeline/meshing/part_mesher.h"

#include "body/sizing/background_choice.h"
#include "pipeline/domain/body_options.h"

namespace umtet {

std::shared_ptr<const WrittenInParts> written_in_parts(const std::shared_ptr<const MeshInParts>& mesh) {
  return std::static_pointer_cast<const WrittenInParts>(mesh);
}

std::optional<Message> for_one_process(const Parameters& parameters) {
  const MeshParameters& mesh = parameters.mesh();
  if (mesh.mode != UmMode::Fast) return Message{Setting(Option{keys::mesh::mode}, "paper")};
  if (mesh.box_walls || mesh.complement) return "a mesh with walls";
  if (mesh.keep_iterates) return Message{Option{keys::mesh::keep_iterates}};
  if (background_file(parameters) || is_graded(parameters)) return "a background that is not a lattice";
  return std::nullopt;
}

}  // namespace umtet
