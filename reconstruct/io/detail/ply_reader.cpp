// Our own reader, because the libraries at hand lose data or die on what is out there: PCL 1.13 reads coordinates
// stored as double (what Open3D writes) as zeros and reports success, and it aborts on a vertex count it cannot
// allocate; OpenMesh 9 takes a cut ascii body for a whole one; VTK 9.1 crashes on wrong list lengths.

#include "reconstruct/io/detail/cloud_source.h"
#include "reconstruct/io/detail/ply_body.h"
#include "reconstruct/io/detail/ply_header.h"

namespace umtet::detail {
namespace {

CloudColumns vertex_columns(const CloudSource& source, const PlyHeader& header) {
  std::vector<std::string> names;
  for (const PlyElement& element : header.elements)
    if (element.name == "vertex")
      for (const PlyProperty& p : element.properties) names.push_back(p.is_list ? "list " + p.name : p.name);
  return cloud_columns(source, names, "property");
}

/// The first element that takes bytes begins where the header ends.
template <class Body>
void check_first_count(const CloudSource& head, const PlyHeader& header) {
  for (const PlyElement& element : header.elements)
    if (Body::bytes_per_item(element) > 0) return check_count(head, Body(head, header), element);
}

template <class Body>
OrientedPointCloud read_body(const CloudSource& source, const PlyHeader& header) {
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
    cloud.points.reserve(element.count);
    if (columns.has_normals) cloud.normals.reserve(element.count);
    if (columns.has_labels) cloud.labels.reserve(element.count);
    if (columns.has_origins) cloud.origins.reserve(element.count);
    for (std::uint64_t item = 0; item < element.count; ++item) {
      body.read_item(element, item, values);
      append_point(source, cloud, values, columns);
    }
  }
  body.finish();
  return cloud;
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

CloudFile read_ply(const CloudSource& source) {
  const PlyHeader header = parse_ply_header(source);
  switch (header.format) {
    case PlyFormat::Ascii:
      return {read_body<AsciiBody>(source, header), {.format = "ply ascii"}};
    case PlyFormat::BinaryLittleEndian:
      return {read_body<BinaryBody>(source, header), {.format = "ply binary little endian"}};
    case PlyFormat::BinaryBigEndian:
      break;
  }
  return {read_body<BinaryBody>(source, header), {.format = "ply binary big endian"}};
}

}  // namespace umtet::detail
