#pragma once

#include "pipeline/reports/certificate_report.h"
#include "pipeline/reports/stage_reports.h"

namespace umtet {

/// What the records of 1-cloud and 2-level-set say about normals, as shares of the points.
InputFacts input_facts(const CloudReport& cloud, const LevelSetReport& level_set);

}  // namespace umtet
