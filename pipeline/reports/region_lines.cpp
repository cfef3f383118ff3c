#include "pipeline/reports/region_lines.h"

#include <fmt/format.h>

#include "mesh/io/solver_mesh.h"

namespace umtet {

std::string region_lines(const RegionCertificate& certificate, const std::vector<std::string>& names,
                         bool is_compared) {
  std::string text = fmt::format("{:<16} {:>10} {:>8} {:>8} {:>14} {:>7} {:>7}\n", "region", "tets", "least Q", "1 % Q",
                                 "volume", "pieces", "Euler");
  for (const RegionMeasures& m : certificate.regions)
    text += fmt::format("{:<16} {:>10} {:>8.3f} {:>8.3f} {:>14.6g} {:>7} {:>7}\n",
                        names[static_cast<std::size_t>(m.region)], m.certificate.n_tets, m.certificate.quality.min,
                        m.certificate.quality.p01, m.certificate.volume, m.n_pieces,
                        m.certificate.boundary.euler_characteristic);
  for (const InterfaceMeasures& m : certificate.interfaces) {
    text +=
        fmt::format("interface {}: {} faces, area {:.6g}", interface_name(names, m.region, m.other), m.n_faces, m.area);
    if (is_compared)
      text += fmt::format(", vertices within {:.1g} h, face centres within {:.2g} h", m.max_vertex_distance,
                          m.max_centroid_distance);
    text += "\n";
  }
  return text;
}

}  // namespace umtet
