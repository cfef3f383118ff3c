#include "pipeline/meshing/defect_files.h"

#include <cstdint>

#include "mesh/io/points_io.h"
#include "mesh/io/tet_mesh_io.h"
#include "pipeline/case/artefact.h"
#include "pipeline/case/exit_code.h"

namespace umtet {

void write_defects(const std::filesystem::path& file, const std::vector<MeshDefect>& defects) {
  std::vector<Vec3> points;
  std::vector<double> off, size, feature;
  std::vector<std::uint8_t> kind, small;
  std::vector<std::int64_t> n;
  for (const MeshDefect& defect : defects) {
    points.push_back(defect.where);
    kind.push_back(static_cast<std::uint8_t>(defect.kind));
    off.push_back(defect.off_over_h);
    size.push_back(defect.size_over_h);
    feature.push_back(defect.feature_over_h.value_or(0));
    small.push_back(is_small(defect) ? 1 : 0);
    n.push_back(static_cast<std::int64_t>(defect.n));
  }
  write_artefact(file, [&](const std::filesystem::path& temporary) {
    write_vtp(temporary, points,
              {{"kind", kind},
               {"off_over_h", off},
               {"size_over_h", size},
               {"feature_over_h", feature},
               {"small", small},
               {"n", n}});
  });
}

void write_marked(const std::filesystem::path& file, const std::vector<MarkedSample>& marked) {
  std::vector<Vec3> points;
  std::vector<std::uint8_t> marks;
  for (const MarkedSample& sample : marked) {
    points.push_back(sample.where);
    marks.push_back(static_cast<std::uint8_t>(sample.mark));
  }
  write_artefact(file, [&](const std::filesystem::path& temporary) {
    write_vtp(temporary, points, {{"mark", marks}});
  });
}

std::vector<MarkedSample> read_marked(const std::filesystem::path& file) {
  const PointFile content = [&] {
    try {
      return read_points(file);
    } catch (const MeshFileRefused& e) {
      throw ArtefactDamaged(e.what());
    }
  }();
  const auto marks = content.point_data.find("mark");
  const auto* values =
      marks == content.point_data.end() ? nullptr : std::get_if<std::vector<std::uint8_t>>(&marks->second);
  if (!values) throw ArtefactDamaged(file.string() + ": has no array mark");
  std::vector<MarkedSample> marked;
  for (std::size_t i = 0; i < content.points.size(); ++i)
    marked.push_back({content.points[i], static_cast<SampleMark>((*values)[i])});
  return marked;
}

void write_thin_places(const std::filesystem::path& file, const ThinPlaces& thin, const Vec3& shift) {
  std::vector<Vec3> points = thin.points;
  std::vector<double> h_needed;
  std::vector<std::int64_t> place;
  std::vector<std::uint8_t> gap;
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] += shift;
    place.push_back(thin.place[i]);
    h_needed.push_back(thin.places[thin.place[i]].h_needed);
    gap.push_back(thin.places[thin.place[i]].is_gap);
  }
  write_artefact(file, [&](const std::filesystem::path& temporary) {
    write_vtp(temporary, points,
              {{"thickness", thin.thickness}, {"h_needed", h_needed}, {"place", place}, {"gap", gap}});
  });
}

}  // namespace umtet
