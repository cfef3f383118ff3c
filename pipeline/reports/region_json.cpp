#include "pipeline/reports/region_json.h"

#include <utility>

#include "mesh/io/solver_mesh.h"
#include "pipeline/case/version.h"
#include "pipeline/reports/certificate_json.h"
#include "pipeline/reports/mesh_json.h"

namespace umtet {
namespace {

const char* name_of(RegionDefect::Kind kind) {
  switch (kind) {
    case RegionDefect::Kind::Connectivity:
      return "connectivity";
    case RegionDefect::Kind::NotOnStratum:
      return "off";
    case RegionDefect::Kind::Lost:
      return "lost";
  }
  return "";
}

}  // namespace

Json json_of_regions(const RegionCertificate& certificate, const std::vector<std::string>& names) {
  Json list = Json::array();
  for (const RegionMeasures& m : certificate.regions) {
    Json region = {{"region", m.region}, {"name", names[static_cast<std::size_t>(m.region)]}};
    region.update(to_json(m.certificate));
    region["pieces"] = m.n_pieces;
    region["min_quality_off_boundary"] = m.min_quality_off_boundary;
    list.push_back(std::move(region));
  }
  return list;
}

Json json_of_interfaces(const RegionCertificate& certificate, const std::vector<std::string>& names, bool is_compared) {
  Json list = Json::array();
  const auto compared = [&](auto value) { return is_compared ? Json(value) : Json(nullptr); };
  for (const InterfaceMeasures& m : certificate.interfaces)
    list.push_back({{"name", interface_name(names, m.region, m.other)},
                    {"region", names[static_cast<std::size_t>(m.region)]},
                    {"other", names[static_cast<std::size_t>(m.other)]},
                    {"faces", m.n_faces},
                    {"area", m.area},
                    {"max_vertex_distance_over_h", compared(m.max_vertex_distance)},
                    {"max_centroid_distance_over_h", compared(m.max_centroid_distance)},
                    {"min_cos_normal", compared(m.min_cos_normal)},
                    {"corners_off", compared(m.n_off)},
                    {"faces_folded", compared(m.n_folded)}});
  return list;
}

Json document_of_regions(const RegionBodyMesh& made) {
  const RegionCertificate& certificate = made.certificate;
  const std::vector<std::string>& names = made.names;
  Json json = document_head(kVersion);
  json["verdict"] = made.reasons.empty() ? "pass" : "fail";
  json["reasons"] = made.reasons;
  json.update(to_json(certificate.whole));
  json["regions"] = json_of_regions(certificate, names);
  json["interfaces"] = json_of_interfaces(certificate, names, true);
  json["samples"] = Json::array();
  for (const MissedBodySamples& m : made.missed)
    json["samples"].push_back({{"region", names[static_cast<std::size_t>(m.region)]},
                               {"visible", m.n_visible},
                               {"missed", m.n_missed},
                               {"farthest", m.farthest},
                               {"where", json_of(m.where)}});
  json["voxels"] = Json::array();
  for (const RegionVoxels& r : made.voxels)
    json["voxels"].push_back({{"region", names[static_cast<std::size_t>(r.region)]},
                              {"label", r.label},
                              {"voxels", r.n_voxels},
                              {"volume_of_voxels", r.volume_of_voxels},
                              {"volume", r.volume},
                              {"pieces_by_points", r.pieces.by_points},
                              {"pieces_by_faces", r.pieces.by_faces},
                              {"thickness", r.thickness}});
  json["periodic"] = nullptr;
  if (made.match)
    json["periodic"] = {{"sides", json_of(made.sides)},
                        {"pairs", made.match->n_pairs},
                        {"farthest", made.match->farthest},
                        {"faces_matched", made.match->sides.size()},
                        {"faces_unmatched", made.match->n_unmatched}};
  json["defects"] = Json::array();
  for (const RegionDefect& d : made.mesh.defects) {
    Json regions = Json::array();
    for (const int r : d.regions) regions.push_back(names[static_cast<std::size_t>(r)]);
    json["defects"].push_back({{"kind", name_of(d.kind)}, {"where", json_of(d.where)}, {"regions", regions}});
  }
  return json;
}

}  // namespace umtet
