#pragma once

#include "body/label_report.h"
#include "pipeline/case/json_values.h"

namespace umtet {

/// Returns the block `labels`.
Json to_json(const LabelVolumeReport& report);
LabelVolumeReport label_volume_from(const Json& json);

}  // namespace umtet
