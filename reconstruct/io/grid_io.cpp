#include "reconstruct/io/grid_io.h"

#include "common/formatted.h"
#include "reconstruct/io/detail/grids/grid_source.h"

namespace umtet {
namespace {

Grid read_by_head(detail::GridSource& source) {
  const std::string_view head = source.head();
  if (head.starts_with("NRRD000")) return detail::read_nrrd(source);
  if (head.starts_with("# vtk DataFile")) return detail::read_structured_points(source);
  if (head.substr(0, 200).find("<VTKFile") != std::string_view::npos) return detail::read_image_data(source);
  if (head.size() >= 348 && (head.substr(344, 3) == "n+1" || head.substr(344, 3) == "ni1")) {
    return detail::read_nifti(source);
  }
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

void check_grid_head(const std::filesystem::path& file, double max_nodes) {
  detail::GridSource source(file, max_nodes, detail::GridSource::Part::Head);
  try {
    read_by_head(source);
  } catch (const detail::EndOfHead&) {
  }
}

}  // namespace umtet
