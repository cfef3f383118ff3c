#include "pipeline/cli/batch_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <string_view>

#include "pipeline/case/artefact.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/json_fields.h"
#include "pipeline/case/version.h"
#include "pipeline/output/report_page.h"
#include "pipeline/run/csv_field.h"

namespace umtet {
namespace fs = std::filesystem;

void list_fields(JsonFields& json, BatchRow& r) {
  json("scan", r.scan)("case", r.name)("verdict", r.verdict)("exit_code", r.exit_code)("reason", r.reason);
  json("seconds", r.seconds)("peak_memory_MB", r.peak_memory_MB)("n_tets", r.n_tets);
  json("min_quality", r.min_quality)("key", r.key);
}

namespace {

constexpr int kSchema = 1;

/// Returns a file name for use in a link: every character other than letters, digits and -._~/ becomes %XX.
std::string link(std::string_view name) {
  std::string out;
  for (const char c : name) {
    const bool plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                       std::string_view("-._~/").find(c) != std::string_view::npos;
    out += plain ? std::string(1, c) : fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return out;
}

std::string tets(const BatchRow& row) { return row.n_tets ? fmt::format("{}", *row.n_tets) : ""; }
std::string quality(const BatchRow& row) { return row.min_quality ? fmt::format("{:.4f}", *row.min_quality) : ""; }
std::string code(const BatchRow& row) { return row.exit_code < 0 ? "" : fmt::format("{}", row.exit_code); }

std::string csv(const std::vector<BatchRow>& rows) {
  std::string out = "scan,case,verdict,exit_code,reason,seconds,peak_memory_MB,n_tets,min_quality\n";
  for (const BatchRow& r : rows) {
    out += fmt::format("{},{},{},{},{},{:.2f},{:.0f},{},{}\n", csv_field(r.scan), csv_field(r.name), r.verdict, code(r),
                       csv_field(r.reason), r.seconds, r.peak_memory_MB, tets(r), quality(r));
  }
  return out;
}

// Blue and orange of Okabe and Ito can be distinguished by all readers; the words say the same without colour.
constexpr const char* kHead = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>umtet batch</title><style>
body{font:15px/1.4 sans-serif;margin:2em;color:#222}
table{border-collapse:collapse}
th,td{padding:.3em .8em;text-align:left;vertical-align:top;border-bottom:1px solid #ddd}
.n{text-align:right;font-variant-numeric:tabular-nums}
.pass{border-left:6px solid #0072b2}.none{border-left:6px solid #d55e00}.waiting{border-left:6px solid #999}
td.r{white-space:pre-wrap;max-width:60em}
</style></head><body>
)";

std::string html(const std::vector<BatchRow>& rows) {
  const auto n = [&](const char* verdict) {
    return std::count_if(rows.begin(), rows.end(), [&](const BatchRow& r) { return r.verdict == verdict; });
  };
  std::string out = kHead;
  out += fmt::format("<h1>{} of {} scans pass</h1>\n", n("pass"), rows.size());
  if (n(kWaiting) > 0) out += fmt::format("<p>{} not run yet.</p>\n", n(kWaiting));
  out +=
      "<table><thead><tr><th>scan</th><th>verdict</th><th>reason</th><th class=\"n\">s</th><th class=\"n\">MB</th>"
      "<th class=\"n\">tets</th><th class=\"n\">min Q</th><th>log</th></tr></thead><tbody>\n";
  for (const BatchRow& r : rows) {
    const bool waits = r.verdict == kWaiting;
    const char* look = r.verdict == "pass" ? "pass" : waits ? "waiting" : "none";
    const std::string exit = r.exit_code > 0 ? fmt::format(" (exit {})", r.exit_code) : "";
    out += fmt::format(
        "<tr><td class=\"{}\"><a href=\"{}/\">{}</a></td><td>{}{}</td><td class=\"r\">{}</td>"
        "<td class=\"n\">{:.1f}</td><td class=\"n\">{:.0f}</td><td class=\"n\">{}</td>"
        "<td class=\"n\">{}</td><td>",
        look, link(r.name), html_text(r.scan), r.verdict, exit, html_text(r.reason), r.seconds, r.peak_memory_MB,
        tets(r), quality(r));
    out += waits ? "</td></tr>\n" : fmt::format("<a href=\"logs/{}.log\">log</a></td></tr>\n", link(r.name));
  }
  return out + "</tbody></table></body></html>\n";
}

std::function<void(const fs::path&)> writer(std::string text) {
  return [text = std::move(text)](const fs::path& file) { write_text_artefact(file, text); };
}

}  // namespace

std::string verdict_of(int exit_code) {
  // In the order of the codes.
  constexpr std::array kWords = {"pass",    "crash", "usage",        "refused", "no fit",
                                 "no mesh", "fail",  "file trouble", "corrupt", "limit"};
  static_assert(kWords.size() == static_cast<std::size_t>(ExitCode::ResourceLimit) + 1);
  const auto code = static_cast<ExitCode>(exit_code);
  if (code == ExitCode::Interrupted || code == ExitCode::Terminated) return "stopped";
  return exit_code >= 0 && exit_code < static_cast<int>(kWords.size()) ? kWords[exit_code] : "crash";
}

std::vector<fs::path> batch_files(const fs::path& folder) {
  return {folder / "batch.csv", folder / "batch.html", folder / "batch.json"};
}

Json batch_rows(const std::vector<BatchRow>& rows) {
  Json list = Json::array();
  for (const BatchRow& r : rows) list.push_back(json_by_fields(r));
  return list;
}

void write_batch(const fs::path& folder, const std::vector<BatchRow>& rows) {
  const Json document = {
      {"schema", kSchema}, {"version", kVersion}, {"rows", batch_rows(rows)}, {"run", Json::object()}};
  const std::vector<fs::path> files = batch_files(folder);
  write_artefacts(
      {{files[0], writer(csv(rows))}, {files[1], writer(html(rows))}, {files[2], writer(file_text(sealed(document)))}});
}

std::vector<BatchRow> read_batch(const fs::path& folder) {
  const fs::path file = batch_files(folder).back();
  if (!fs::exists(file)) return {};
  std::vector<BatchRow> rows;
  try {
    const Json document = Json::parse(read_text(file));
    if (document.at("schema") != kSchema || document.at("version") != kVersion || !seal_holds(document)) return {};
    for (const Json& row : document.at("rows")) rows.push_back(read_fields<BatchRow>(row));
  } catch (const Json::exception&) {
    return {};
  }
  return rows;
}

}  // namespace umtet
