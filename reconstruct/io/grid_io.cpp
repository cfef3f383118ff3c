#include "reconstruct/io/grid_io.h"

#include "common/formatted.h"
#include "reconstruct/io/detail/grids/grid_source.h"

namespace umtet {
namespace {

using Reader = Grid (*)(detail::GridSource&);

/// Null for what is none of the formats.
Reader reader_of(std::string_view head) {
  if (head.starts_with("NRRD000")) return detail::read_nrrd;
  if (head.starts_with("# vtk DataFile")) return detail::read_structured_points;
  if (head.substr(0, 200).find("<VTKFile") != std::string_view::npos) return detail::read_image_data;
  const bool is_nifti = head.size() >= 348 && (head.substr(344, 3) == "n+1" || head.substr(344, 3) == "ni1");
  return is_nifti ? detail::read_nifti : nullptr;
}

Grid read_by_head(detail::GridSource& source) {
  const std::string_view head = source.head();
  if (const Reader read = reader_of(head)) return read(source);
  if (head.size() >= 8 && head.substr(4, 3) == "n+2") {
    source.refuse("NIfTI-2 is not read: save it as NIfTI-1 (nifti_tool, or nibabel's Nifti1Image)");
  }
  source.refuse("neither VTK ImageData (.vti) or structured points (.vtk), NRRD nor NIfTI");
}

}  // namespace

Grid read_grid(const std::filesystem::path& file, double max_nodes) {
  detail::GridSource source(file, max_nodes);
  Grid grid = read_by_head(source);
  if (const auto wrong = problems(grid); !wrong.empty()) throw GridRefused(source.name() + ": " + joined(wrong, "; "));
  return grid;
}

bool is_grid_file(const InputFile& file) {
  if (!S_ISREG(file.status().st_mode)) return false;
  detail::GridSource source(file, 1e9, detail::GridSource::Part::Head);
  const std::string_view head = source.head();
  return reader_of(head) != nullptr || (head.size() >= 8 && head.substr(4, 3) == "n+2");
}

void check_grid_head(const std::filesystem::path& file, double max_nodes) {
  detail::GridSource source(file, max_nodes, detail::GridSource::Part::Head);
  try {
    read_by_head(source);
  } catch (const detail::EndOfHead&) {
  }
}

}  // namespace umtet
