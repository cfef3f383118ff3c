#include "reconstruct/io/image_io.h"

#include <stdexcept>

#include "reconstruct/io/detail/grids/vti_writer.h"

namespace umtet {

void write_image(const std::filesystem::path& file, const Image& image) {
  if (image.values.empty()) throw std::invalid_argument("write_image: no values");
  const detail::ImageNodes nodes{image.n, image.origin, image.spacing};
  detail::AppendedWriter out;
  detail::begin_image(out, nodes);
  detail::begin_point_data(out, nodes, image.values.front().first);
  for (const auto& [name, values] : image.values) {
    if (static_cast<std::int64_t>(values.size()) != image.n.cast<std::int64_t>().prod()) {
      throw std::invalid_argument("write_image: '" + name + "': one number a node is needed");
    }
    out.array(name, std::span(values));
  }
  detail::write_image(file, out);
}

}  // namespace umtet
