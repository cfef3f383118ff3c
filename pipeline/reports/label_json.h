#pragma once

#include "body/label_report.h"
#include "pipeline/case/json_fields.h"

namespace umtet {

/// The block `labels`.
void list_fields(JsonFields& json, LabelVolumeReport& report);

}  // namespace umtet
