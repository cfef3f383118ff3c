#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "reconstruct/io/detail/clouds/ply_body.h"
#include "reconstruct/io/detail/clouds/ply_header.h"
#include "reconstruct/io/detail/triangles/polygon_soup.h"

namespace umtet::detail {
namespace {

// Faces for each vertex: a closed surface of triangles has two, of quads one, of triangles that share no corner a
// third.
constexpr double kFewestFaces = .25;

std::optional<std::size_t> index_list(const PlyElement& face) {
  for (std::size_t p = 0; p < face.properties.size(); ++p) {
    const PlyProperty& property = face.properties[p];
    if (property.is_list && (property.name == "vertex_indices" || property.name == "vertex_index")) return p;
  }
  return std::nullopt;
}

std::optional<std::size_t> label_property(const PlyElement& face) {
  for (const std::string_view name : {"label", "patch"})
    for (std::size_t p = 0; p < face.properties.size(); ++p)
      if (!face.properties[p].is_list && face.properties[p].name == name) return p;
  return std::nullopt;
}

std::size_t column(const CloudSource& source, const PlyElement& vertex, std::string_view name) {
  for (std::size_t p = 0; p < vertex.properties.size(); ++p)
    if (!vertex.properties[p].is_list && vertex.properties[p].name == name) return p;
  refuse(source, fmt::format("the vertices have no property {}: export the surface again", name));
}

template <class Body>
void read_vertices(const CloudSource& source, Body& body, const PlyElement& vertex, PolygonSoup& soup) {
  const std::array<std::size_t, 3> at = {column(source, vertex, "x"), column(source, vertex, "y"),
                                         column(source, vertex, "z")};
  std::vector<double> values(vertex.properties.size());
  soup.V.reserve(vertex.count);
  for (std::uint64_t item = 0; item < vertex.count; ++item) {
    body.read_item(vertex, item, values);
    soup.V.emplace_back(values[at[0]], values[at[1]], values[at[2]]);
  }
}

template <class Body>
void read_faces(const CloudSource& source, Body& body, const PlyElement& face, PolygonSoup& soup) {
  PlyList corners{.property = index_list(face).value(), .most = kMostCorners, .values = {}};
  const std::optional<std::size_t> label = label_property(face);
  std::vector<double> values(face.properties.size());
  for (std::uint64_t item = 0; item < face.count; ++item) {
    body.read_item(face, item, values, &corners);
    for (const double v : corners.values) {
      if (v != std::trunc(v) || std::abs(v) > std::numeric_limits<int>::max())
        refuse(source, fmt::format("{}: {} is no number of a vertex", place_of(face, item), v));
      soup.corners.push_back(static_cast<std::int64_t>(v));
    }
    soup.ends.push_back(soup.corners.size());
    if (!label) continue;
    const double l = values[*label];
    if (l != std::trunc(l) || std::abs(l) > std::numeric_limits<int>::max())
      refuse(source, fmt::format("{}: its label is {}: labels are whole numbers of 32 bits", place_of(face, item), l));
    soup.labels.push_back(static_cast<int>(l));
  }
}

/// The columns of the ends of an edge, if it has both.
std::optional<std::array<std::size_t, 2>> edge_ends(const PlyElement& edge) {
  std::array<std::size_t, 2> at = {edge.properties.size(), edge.properties.size()};
  for (std::size_t p = 0; p < edge.properties.size(); ++p) {
    if (edge.properties[p].is_list) continue;
    if (edge.properties[p].name == "vertex1") at[0] = p;
    if (edge.properties[p].name == "vertex2") at[1] = p;
  }
  if (std::max(at[0], at[1]) == edge.properties.size()) return std::nullopt;
  return at;
}

template <class Body>
void read_edges(const CloudSource& source, Body& body, const PlyElement& edge, PolygonSoup& soup) {
  const std::optional<std::array<std::size_t, 2>> at = edge_ends(edge);
  std::vector<double> values(edge.properties.size());
  for (std::uint64_t item = 0; item < edge.count; ++item) {
    body.read_item(edge, item, values);
    if (!at) continue;
    std::array<int, 2> ends;
    for (std::size_t k = 0; k < 2; ++k) {
      const double v = values[(*at)[k]];
      if (v != std::trunc(v) || v < 0 || v > std::numeric_limits<int>::max())
        refuse(source, fmt::format("{}: {} is no number of a vertex", place_of(edge, item), v));
      ends[k] = static_cast<int>(v);
    }
    soup.lines.push_back(ends);
  }
}

template <class Body>
PolygonSoup read_soup(const CloudSource& source, const PlyHeader& header) {
  PolygonSoup soup;
  Body body(source, header);
  std::vector<double> values;
  for (const PlyElement& element : header.elements) {
    if (Body::bytes_per_item(element) == 0) continue;
    check_count(source, body, element);
    if (element.name == "vertex") {
      read_vertices(source, body, element, soup);
    } else if (element.name == "face") {
      read_faces(source, body, element, soup);
    } else if (element.name == kSharpEdges) {
      read_edges(source, body, element, soup);
    } else {
      values.resize(element.properties.size());
      for (std::uint64_t item = 0; item < element.count; ++item) body.read_item(element, item, values);
    }
  }
  body.finish();
  return soup;
}

}  // namespace

bool ply_has_surface(const CloudSource& head) {
  PlyHeader header;
  try {
    header = parse_ply_header(head);
  } catch (const CloudRefused&) {
    return false;
  }
  std::uint64_t n_vertices = 0, n_faces = 0;
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex") n_vertices = element.count;
    if (element.name == "face" && index_list(element)) n_faces = element.count;
  }
  return n_faces > 0 && static_cast<double>(n_faces) >= kFewestFaces * static_cast<double>(n_vertices);
}

TriangleFile read_ply_faces(const CloudSource& source) {
  const PlyHeader header = parse_ply_header(source);
  switch (header.format) {
    case PlyFormat::Ascii:
      return triangles_of(source, read_soup<AsciiBody>(source, header), "ply ascii, faces");
    case PlyFormat::BinaryLittleEndian:
      return triangles_of(source, read_soup<BinaryBody>(source, header), "ply binary little endian, faces");
    case PlyFormat::BinaryBigEndian:
      break;
  }
  return triangles_of(source, read_soup<BinaryBody>(source, header), "ply binary big endian, faces");
}

}  // namespace umtet::detail
