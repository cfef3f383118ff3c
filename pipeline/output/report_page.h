#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/case/record.h"
#include "pipeline/reports/certificate_report.h"
#include "reconstruct/solve/multilevel_fit.h"

namespace umtet {

/// The text with &, <, > and " as HTML has them.
std::string html_text(const std::string& text);

/// JSON that may stand in a <script>: no '<' in it.
std::string script_json(const Json& json);

/// Parts of the page, by the name of their place in report/page.html. Every number of a certificate stands in an
/// element with `data-certificate`, its JSON pointer.
std::string reason_list(const Certificate& certificate);
std::string check_list(const Certificate& certificate);
std::string headline_cards(const Certificate& certificate);

/// Seconds and memory of the stages, with bars. @param records  of the stages that were run
std::string stage_table(const std::vector<StageRecord>& records);
/// The levels of a multilevel fit; empty when there are none.
std::string band_table(const std::vector<BandReport>& bands);
/// Every parameter, from the text of case.toml; those that are not defaults stand out.
std::string parameter_table(const std::string& case_toml);
/// Every value of certificate.json, as it is in the file.
std::string certificate_table(const Json& certificate);

/// The template with every {{name}} replaced. \throw std::invalid_argument naming a place without a value
std::string filled(std::string_view page, const std::map<std::string, std::string>& places);

/// RFC 4648, with padding.
std::string base64(const void* data, std::size_t size);

}  // namespace umtet
