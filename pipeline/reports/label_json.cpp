#include "pipeline/reports/label_json.h"

namespace umtet {

void list_fields(JsonFields& json, PieceCount& count) {
  json("by_points", count.by_points)("by_faces", count.by_faces);
}

void list_fields(JsonFields& json, LabelVolumeReport& r) {
  json("part", r.part);
  json("kernel", r.kernel);
  json("n_voxels", r.n_voxels);
  json("volume_of_voxels", r.volume_of_voxels);
  json("volume_of_psi", r.volume_of_psi);
  json("volume_of_mesh", r.volume_of_mesh);
  json("pieces", r.pieces);
  json("pieces_of_mesh", r.pieces_of_mesh);
  json("cavities", r.cavities);
  json("cavities_of_mesh", r.cavities_of_mesh);
  json("n_changed", r.n_changed);
  json("n_changed_by_more_than_half_a_voxel", r.n_changed_far);
  json("farthest_changed_voxels", r.farthest_changed);
  json("farthest_changed_at", r.farthest_at);
}

}  // namespace umtet
