// Our own reader, because the libraries at hand lose data or die on what is out there: PCL 1.13 reads coordinates
// stored as double (what Open3D writes) as zeros and reports success, and it aborts on a vertex count it cannot
// allocate; OpenMesh 9 takes a cut ascii body for a whole one; VTK 9.1 crashes on wrong list lengths.

#include <algorithm>
#include <utility>

#include "reconstruct/io/detail/clouds/cloud_columns.h"
#include "reconstruct/io/detail/clouds/cloud_readers.h"
#include "reconstruct/io/detail/clouds/ply_body.h"
#include "reconstruct/io/detail/clouds/ply_header.h"

namespace umtet::detail {
namespace {

/// Colours in floating point are 0..1, in 16 bits 0..65535.
double bytes_per_unit(PlyType type) {
  if (type == PlyType::Float32 || type == PlyType::Float64) return 255;
  return type == PlyType::UInt16 ? 255. / 65535 : 1;
}

CloudColumns vertex_columns(const CloudSource& source, const PlyHeader& header) {
  const auto vertex = std::find_if(header.elements.begin(), header.elements.end(),
                                   [](const PlyElement& element) { return element.name == "vertex"; });
  std::vector<std::string> names;
  for (const PlyProperty& p : vertex->properties) names.push_back(p.is_list ? "list " + p.name : p.name);
  CloudColumns columns = cloud_columns(source, names, "property");
  if (!columns.fields.colour.empty())
    columns.fields.bytes_per_unit = bytes_per_unit(vertex->properties[columns.fields.colour.front()].type);
  return columns;
}

/// The first element that takes bytes begins where the header ends.
template <class Body>
void check_first_count(const CloudSource& head, const PlyHeader& header) {
  for (const PlyElement& element : header.elements)
    if (Body::bytes_per_item(element) > 0) return check_count(head, Body(head, header), element);
}

template <class Body>
CloudFile read_body(const CloudSource& source, const PlyHeader& header, const char* format) {
  OrientedPointCloud cloud;
  Body body(source, header);
  const CloudColumns columns = vertex_columns(source, header);
  std::vector<double> values;
  for (const PlyElement& element : header.elements) {
    if (Body::bytes_per_item(element) == 0) continue;  // no properties, no bytes
    check_count(source, body, element);
    values.resize(element.properties.size());
    if (element.name != "vertex") {
      for (std::uint64_t item = 0; item < element.count; ++item) body.read_item(element, item, values);
      continue;
    }
    begin_cloud(cloud, columns, element.count);
    for (std::uint64_t item = 0; item < element.count; ++item) {
      body.read_item(element, item, values);
      append_point(source, cloud, values, columns);
    }
  }
  body.finish();
  return {std::move(cloud), {.format = format, .fields_left_out = columns.fields.left_out}};
}

}  // namespace

void check_ply_head(const CloudSource& head) {
  const PlyHeader header = parse_ply_header(head);
  vertex_columns(head, header);
  if (header.format == PlyFormat::Ascii)
    check_first_count<AsciiBody>(head, header);
  else
    check_first_count<BinaryBody>(head, header);
}

bool is_in_blocks_ply(const CloudSource& head) { return parse_ply_header(head).format != PlyFormat::Ascii; }

CloudFile read_ply(const CloudSource& source) {
  const PlyHeader header = parse_ply_header(source);
  switch (header.format) {
    case PlyFormat::Ascii:
      return read_body<AsciiBody>(source, header, "ply ascii");
    case PlyFormat::BinaryLittleEndian:
      return read_body<BinaryBody>(source, header, "ply binary little endian");
    case PlyFormat::BinaryBigEndian:
      break;
  }
  return read_body<BinaryBody>(source, header, "ply binary big endian");
}

}  // namespace umtet::detail
