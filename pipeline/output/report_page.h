#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pipeline/case/record.h"
#include "pipeline/reports/certificate_report.h"
#include "reconstruct/solve/multilevel_fit.h"

namespace umtet {

/// Returns the text with &, <, > and " escaped for HTML.
std::string html_text(const std::string& text);

/// Returns JSON for use in a <script>; it contains no '<'.
std::string script_json(const Json& json);

/// Parts of the page, by the names of their placeholders in report/page.html. Every number of a certificate is in an
/// element with `data-certificate`, its JSON pointer.
std::string reason_list(const Certificate& certificate);
std::string check_list(const Certificate& certificate);
std::string headline_cards(const Certificate& certificate);

/// Returns seconds and memory of the stages, with bars. @param records  records of the stages that were run
std::string stage_table(const std::vector<StageRecord>& records);
/// Returns the levels of a multilevel fit; empty if there are none.
std::string band_table(const std::vector<BandReport>& bands);
/// Returns every parameter in the text of case.toml; values that differ from the defaults are highlighted.
std::string parameter_table(const std::string& case_toml);
/// Returns every value of certificate.json, as in the file.
std::string certificate_table(const Json& certificate);

/// Returns the template with every {{name}} replaced. \throw std::invalid_argument  names a placeholder without a value
std::string filled(std::string_view page, const std::map<std::string, std::string>& places);

/// Returns a page of report/page.html with the program in it.
/// @param parts  the placeholders besides those of the program; missing ones are empty, missing JSON is null
std::string report_page(std::map<std::string, std::string> parts);

/// Returns arrays in base64 as elements of the page.
std::string blocks_text(const std::vector<std::pair<std::string, std::string>>& blocks);

/// Returns base64 of RFC 4648, with padding.
std::string base64(const void* data, std::size_t size);

}  // namespace umtet
