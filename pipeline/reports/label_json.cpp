#include "pipeline/reports/label_json.h"

namespace umtet {
namespace {

Json json_of_pieces(const PieceCount& count) { return {{"by_points", count.by_points}, {"by_faces", count.by_faces}}; }

PieceCount piece_count_from(const Json& json) { return {json.at("by_points"), json.at("by_faces")}; }

}  // namespace

Json to_json(const LabelVolumeReport& r) {
  return {{"part", json_of(r.part)},
          {"kernel", json_of(r.kernel)},
          {"n_voxels", r.n_voxels},
          {"volume_of_voxels", r.volume_of_voxels},
          {"volume_of_psi", r.volume_of_psi},
          {"volume_of_mesh", r.volume_of_mesh},
          {"pieces", json_of_pieces(r.pieces)},
          {"pieces_of_mesh", r.pieces_of_mesh},
          {"cavities", json_of_pieces(r.cavities)},
          {"cavities_of_mesh", r.cavities_of_mesh},
          {"n_changed", r.n_changed},
          {"n_changed_by_more_than_half_a_voxel", r.n_changed_far},
          {"farthest_changed_voxels", r.farthest_changed},
          {"farthest_changed_at", r.farthest_at ? json_of(*r.farthest_at) : Json(nullptr)}};
}

LabelVolumeReport label_volume_from(const Json& json) {
  LabelVolumeReport r;
  r.part = optional_from<std::int64_t>(json.at("part"));
  r.kernel = optional_from<double>(json.at("kernel"));
  r.n_voxels = json.at("n_voxels");
  r.volume_of_voxels = number_from(json.at("volume_of_voxels"));
  r.volume_of_psi = number_from(json.at("volume_of_psi"));
  r.volume_of_mesh = number_from(json.at("volume_of_mesh"));
  r.pieces = piece_count_from(json.at("pieces"));
  r.pieces_of_mesh = json.at("pieces_of_mesh");
  r.cavities = piece_count_from(json.at("cavities"));
  r.cavities_of_mesh = json.at("cavities_of_mesh");
  r.n_changed = json.at("n_changed");
  r.n_changed_far = json.at("n_changed_by_more_than_half_a_voxel");
  r.farthest_changed = number_from(json.at("farthest_changed_voxels"));
  if (!json.at("farthest_changed_at").is_null()) r.farthest_at = vector_from(json.at("farthest_changed_at"));
  return r;
}

}  // namespace umtet
