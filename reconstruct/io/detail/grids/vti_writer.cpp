#include "reconstruct/io/detail/grids/vti_writer.h"

#include <fmt/format.h>

#include <cerrno>
#include <fstream>
#include <system_error>

namespace umtet::detail {
namespace {

std::string extent(const ImageNodes& nodes) {
  return fmt::format("0 {} 0 {} 0 {}", nodes.n[0] - 1, nodes.n[1] - 1, nodes.n[2] - 1);
}

}  // namespace

void begin_image(AppendedWriter& out, const ImageNodes& nodes) {
  const Vec3 &o = nodes.origin, &s = nodes.spacing;
  out.begin("ImageData",
            fmt::format(" WholeExtent=\"{}\" Origin=\"{} {} {}\" Spacing=\"{} {} {}\" Direction=\"1 0 0 0 1 0 0 0 1\"",
                        extent(nodes), o[0], o[1], o[2], s[0], s[1], s[2]))
      .text("<FieldData>\n");
}

void begin_point_data(AppendedWriter& out, const ImageNodes& nodes, const std::string& scalars) {
  out.text(fmt::format("</FieldData>\n<Piece Extent=\"{}\">\n<PointData Scalars=\"{}\">\n", extent(nodes), scalars));
}

void write_image(const std::filesystem::path& path, AppendedWriter& out) {
  out.text("</PointData>\n<CellData>\n</CellData>\n</Piece>\n");
  errno = 0;
  std::ofstream file(path, std::ios::binary);
  out.write([&](std::string_view bytes) { file.write(bytes.data(), static_cast<std::streamsize>(bytes.size())); });
  file.close();
  if (!file) {
    throw std::system_error(errno ? errno : EIO, std::generic_category(),
                            fmt::format("{}: could not be written completely", path.string()));
  }
}

}  // namespace umtet::detail
