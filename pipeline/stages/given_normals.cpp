#include "pipeline/stages/given_normals.h"

#include <fmt/format.h>

#include "pipeline/case/record.h"
#include "pipeline/reports/stage_reports.h"

namespace umtet {
namespace {

// Share of normals that agree with their neighbours; noise and sharp edges alone do not reduce it below this value.
constexpr double kLeastAgreed = .9;

}  // namespace

std::string doubt_about_given_normals(const CasePaths& paths) {
  const StageState state = inspect_stage(paths, Stage::Cloud, Json::object(), std::nullopt);
  if (!state.record) return "";
  const NormalsReport normals = cloud_report(*state.record).normals;
  const double agreed = normals.consistency;
  if (!normals.given || agreed >= kLeastAgreed) return "";
  return fmt::format(
      "\n  {:.1f} % of the given normals agree with their neighbours, as if two sides of a body were closer to "
      "each other than its samples: a level set cannot separate such sides; use more samples",
      100 * agreed);
}

}  // namespace umtet
