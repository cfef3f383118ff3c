#include "reconstruct/io/triangle_mesh_io.h"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <optional>
#include <ostream>

#include "reconstruct/io/detail/clouds/cloud_readers.h"
#include "reconstruct/io/detail/file_bytes.h"
#include "reconstruct/io/detail/little_endian.h"
#include "reconstruct/io/detail/triangles/polygon_soup.h"

namespace umtet {
namespace {

using detail::CloudSource;
using detail::FileBytes;

enum class Format { Stl, Obj, Off, Ply };

/// None: points, or nothing that is known.
std::optional<Format> format_of(const CloudSource& head, const std::filesystem::path& file) {
  if (head.bytes.starts_with("ply\n") || head.bytes.starts_with("ply\r\n"))
    return detail::ply_has_surface(head) ? std::optional(Format::Ply) : std::nullopt;
  if (detail::begins_as_off(head)) return Format::Off;
  const std::string extension = detail::lower_extension(file);
  if (extension == ".stl") return Format::Stl;
  if (extension == ".obj") return Format::Obj;
  if (extension == ".off") return Format::Off;
  return std::nullopt;
}

Format require_format(const CloudSource& head, const std::filesystem::path& file) {
  if (head.bytes.empty()) detail::refuse(head, "the file is empty");
  if (const std::optional<Format> format = format_of(head, file)) return *format;
  detail::refuse(head,
                 "no triangles: neither a PLY with faces nor OFF by its first line, and the extension is none of "
                 ".stl .obj .off");
}

void check_head(const CloudSource& head, const std::filesystem::path& file) {
  const Format format = require_format(head, file);
  if (format != Format::Stl) detail::refuse_endless_line(head);
  if (head.bytes_left_out == 0) return;  // then the reader itself is as fast
  switch (format) {
    case Format::Stl:
      return detail::check_stl_head(head);
    case Format::Obj:
      return detail::check_obj_head(head);
    case Format::Off:
      return detail::check_off_head(head);
    case Format::Ply:
      return detail::check_ply_head(head);
  }
}

TriangleFile parse(const CloudSource& source, const std::filesystem::path& file) {
  switch (require_format(source, file)) {
    case Format::Stl:
      return detail::read_stl(source);
    case Format::Obj:
      return detail::read_obj(source);
    case Format::Off:
      return detail::read_off(source);
    case Format::Ply:
      break;
  }
  return detail::read_ply_faces(source);
}

}  // namespace

bool holds_triangles(const std::filesystem::path& file, PlyFaces faces) {
  return holds_triangles(InputFile(file), faces);
}

bool holds_triangles(const InputFile& file, PlyFaces faces) {
  const std::optional<Format> format = format_of(FileBytes(file).source(false), file.path());
  return format && !(format == Format::Ply && faces == PlyFaces::Ignored);
}

void check_triangles_head(const InputFile& file) { check_head(FileBytes(file).source(false), file.path()); }

TriangleFile read_triangles(const std::filesystem::path& file) { return read_triangles(InputFile(file)); }

TriangleFile read_triangles(const InputFile& file) {
  FileBytes bytes(file);
  check_head(bytes.source(false), file.path());
  bytes.read_rest();
  return parse(bytes.source(false), file.path());
}

void write_ply(std::ostream& out, const TriangleMesh& mesh) {
  const bool has_labels = !mesh.labels.empty();
  out << "ply\nformat binary_little_endian 1.0\nelement vertex " << mesh.V.size() << '\n';
  for (const char* name : {"x", "y", "z"}) out << "property double " << name << '\n';
  out << "element face " << mesh.F.size() << "\nproperty list uchar int vertex_indices\n";
  if (has_labels) out << "property int label\n";
  if (!mesh.lines.empty())
    out << "element " << detail::kSharpEdges << ' ' << mesh.lines.size()
        << "\nproperty int vertex1\nproperty int vertex2\n";
  out << "end_header\n";
  std::array<char, 3 * sizeof(double)> row;
  for (const Vec3& x : mesh.V) {
    char* at = row.data();
    for (int axis = 0; axis < 3; ++axis) detail::put(at, x[axis]);
    out.write(row.data(), at - row.data());
  }
  for (std::size_t f = 0; f < mesh.F.size(); ++f) {
    char* at = row.data();
    detail::put(at, std::uint8_t{3});
    for (const int v : mesh.F[f]) detail::put(at, std::int32_t{v});
    if (has_labels) detail::put(at, std::int32_t{mesh.labels[f]});
    out.write(row.data(), at - row.data());
  }
  for (const std::array<int, 2>& line : mesh.lines) {
    char* at = row.data();
    for (const int v : line) detail::put(at, std::int32_t{v});
    out.write(row.data(), at - row.data());
  }
}

}  // namespace umtet
