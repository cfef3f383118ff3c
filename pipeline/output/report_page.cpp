#include "pipeline/output/report_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace umtet {
namespace {

std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

const Json& at(const Json& certificate, const char* pointer) {
  static const Json kNull = nullptr;
  const Json::json_pointer p(pointer);
  return certificate.contains(p) ? certificate.at(p) : kNull;
}

std::string thousands(const std::string& digits) {
  std::string s = digits;
  for (int k = static_cast<int>(s.size()) - 3; k > 0; k -= 3) s.insert(s.begin() + k, ',');
  return s;
}

/// A value of the certificate, marked with where it is from. Counts have commas, other numbers as many digits as said.
std::string value(const Json& certificate, const char* pointer, int digits = 4) {
  const Json& v = at(certificate, pointer);
  const std::string text = v.is_null()              ? "–"
                           : v.is_number_unsigned() ? thousands(dumped(v))
                           : v.is_number_float()    ? fmt::format("{:.{}g}", v.get<double>(), digits)
                                                    : dumped(v);
  return fmt::format("<span data-certificate=\"{}\">{}</span>", pointer, text);
}

void add_leaves(const Json& json, const std::string& pointer, std::string& rows) {
  if (json.is_object() && !json.empty()) {
    for (const auto& [key, child] : json.items()) add_leaves(child, fmt::format("{}/{}", pointer, key), rows);
    return;
  }
  rows += fmt::format("<tr><td><code>{}</code></td><td><code data-certificate=\"{}\">{}</code></td></tr>\n",
                      html_text(pointer.substr(1)), html_text(pointer), html_text(dumped(json)));
}

std::string details(const char* title, const std::string& content, bool open = false) {
  return fmt::format("<details class=\"table\"{}><summary>{}</summary>\n{}</details>\n", open ? " open" : "", title,
                     content);
}

}  // namespace

std::string html_text(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&') {
      out += "&amp;";
    } else if (c == '<') {
      out += "&lt;";
    } else if (c == '>') {
      out += "&gt;";
    } else if (c == '"') {
      out += "&quot;";
    } else {
      out += c;
    }
  }
  return out;
}

std::string script_json(const Json& json) {
  std::string out;
  for (const char c : dumped(json)) {
    if (c == '<') {
      out += "\\u003c";
    } else {
      out += c;
    }
  }
  return out;
}

std::string reason_list(const Json& certificate) {
  const Json& reasons = certificate.at("reasons");
  if (reasons.empty()) return "";
  std::string out = "<ul class=\"reasons\">\n";
  for (const Json& r : reasons) out += "<li>" + html_text(r.get<std::string>()) + "</li>\n";
  const Json& remedy = at(certificate, "/remedy");
  if (remedy.is_string()) out += "<li>Try " + html_text(remedy.get<std::string>()) + "</li>\n";
  return out + "</ul>";
}

std::string check_list(const Json& c) {
  std::string out;
  const auto add = [&](const std::string& words, const Json& holds) {
    out += fmt::format("<li class=\"{}\">{}</li>\n",
                       holds.is_null()     ? "open"
                       : holds.get<bool>() ? "good"
                                           : "bad",
                       words);
  };
  const Json& inverted = at(c, "/quality/n_inverted");
  add("inverted tets: " + value(c, "/quality/n_inverted"), inverted == 0);
  add("closed manifold boundary", at(c, "/boundary/closed_manifold"));
  add("it is the surface that was to be fitted", at(c, "/boundary/equals_positive_faces"));
  // What cannot be proved is open, not wrong.
  const Json& proved = at(c, "/domain/components_proved");
  add("all pieces of ψ = 0 proved to be seen", proved == true ? proved : Json(nullptr));
  const Json &gap = at(c, "/boundary/gap_over_volume"), &most = at(c, "/gates/volume_gap");
  if (gap.is_number() && most.is_number()) {
    add(fmt::format("between faces and ψ = 0 at most {:.3g} % of the volume", 100 * most.get<double>()), gap <= most);
  }
  const Json& gate = at(c, "/gates/min_quality");
  if (gate.is_number()) {
    add("min Q at least " + value(c, "/gates/min_quality", 6),
        at(c, "/quality/min").get<double>() >= gate.get<double>());
  } else {
    add("no gate on min Q", nullptr);
  }
  return out;
}

std::string headline_cards(const Json& c) {
  std::string out;
  const auto card = [&](const std::string& big, const std::string& small) {
    out += "<div class=\"card\"><b>" + big + "</b><span>" + small + "</span></div>\n";
  };
  const Json& unit = at(c, "/units");
  const std::string units = unit.is_string() ? " " + html_text(unit.get<std::string>()) : "";
  card(value(c, "/n_tets"), "tets, " + value(c, "/n_vertices") + " vertices");
  card(value(c, "/quality/min"), "min mean ratio Q; 1&nbsp;%: " + value(c, "/quality/p01"));
  card(value(c, "/quality/dihedral_min_deg", 3) + "–" + value(c, "/quality/dihedral_max_deg") + "°", "dihedral angles");
  card(value(c, "/h") + units, "edge length h of the background");
  card(value(c, "/boundary/n_faces"),
       "boundary faces; genus " + value(c, "/boundary/genus") + ", pieces " + value(c, "/boundary/components"));
  card(value(c, "/boundary/max_centroid_distance_over_h", 3) + " h",
       "face centres off ψ&nbsp;=&nbsp;0; vertices " + value(c, "/boundary/max_vertex_distance_over_h", 2) + " h");
  if (at(c, "/cloud").is_object()) {
    card(value(c, "/cloud/p99_distance_over_h", 3) + " h",
         "99&nbsp;% of the samples nearer; max " + value(c, "/cloud/max_distance_over_h", 3) + " h");
  }
  return out;
}

std::string stage_table(const std::vector<Json>& records) {
  double total = 0;
  for (const Json& r : records) total += r.at("run").value("seconds", 0.);
  std::string rows = "<tr><th>stage</th><th>seconds</th><th></th><th>peak memory, MB</th><th>threads</th></tr>\n";
  for (const Json& r : records) {
    const Json& run = r.at("run");
    const double s = run.value("seconds", 0.);
    rows += fmt::format(
        "<tr><td>{}</td><td>{:.3g}</td><td class=\"bar\"><i style=\"width:{:.1f}%\"></i></td><td>{:.0f}</td>"
        "<td>{}</td></tr>\n",
        html_text(r.at("stage").get<std::string>()), s, total > 0 ? 100 * s / total : 0,
        run.value("peak_memory_MB", 0.), run.value("threads", 0));
  }
  return "<div class=\"table\"><h2>time and memory of the stages</h2>\n<table>\n" + rows + "</table></div>\n";
}

std::string band_table(const Json& record) {
  const Json bands = record.at("numbers").value("bands", Json::array());
  if (bands.empty()) return "";
  std::string rows =
      "<tr><th>spacing</th><th>samples</th><th>nodes</th><th>iterations</th><th>relative residual</th></tr>\n";
  for (const Json& b : bands) {
    rows += fmt::format("<tr><td>{:.4g}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.2e}</td></tr>\n",
                        b.at("spacing").get<double>(), dumped(b.at("n_samples")), dumped(b.at("n_nodes")),
                        dumped(b.at("iterations")), b.at("residual").get<double>());
  }
  return "<div class=\"table\"><h2>bands of finer lattices in the fit</h2>\n<table>\n" + rows + "</table></div>\n";
}

std::string parameter_table(const std::string& case_toml) {
  std::istringstream in(case_toml);
  std::string line, section, rows = "<tr><th>parameter</th><th>value</th><th>from</th></tr>\n";
  while (std::getline(in, line)) {
    if (line.starts_with("[")) section = line.substr(1, line.find(']') - 1);
    const std::size_t equals = line.find(" = "), hash = line.rfind("  # ");
    if (line.starts_with("#") || equals == std::string::npos || hash == std::string::npos) continue;
    const std::string comment = line.substr(hash + 4), origin = comment.substr(0, comment.find(": "));
    rows +=
        fmt::format("<tr><td><code>{}.{}</code></td><td{}><code>{}</code></td><td>{}</td></tr>\n", html_text(section),
                    html_text(line.substr(0, equals)), origin == "default" ? "" : " class=\"given\"",
                    html_text(line.substr(equals + 3, hash - equals - 3)), html_text(origin));
  }
  return details("effective parameters", "<table>\n" + rows + "</table>");
}

std::string certificate_table(const Json& certificate) {
  std::string rows;
  add_leaves(certificate, "", rows);
  return details("certificate.json", "<table id=\"certificate-table\">\n" + rows + "</table>");
}

std::string filled(std::string_view page, const std::map<std::string, std::string>& places) {
  std::string out;
  while (true) {
    const std::size_t open = page.find("{{");
    out += page.substr(0, open);
    if (open == std::string_view::npos) return out;
    const std::size_t close = page.find("}}", open);
    const std::string name(page.substr(open + 2, close - open - 2));
    const auto it = places.find(name);
    if (it == places.end()) throw std::invalid_argument("no value for " + name);
    out += it->second;
    page.remove_prefix(close + 2);
  }
}

std::string base64(const void* data, std::size_t size) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto* b = static_cast<const unsigned char*>(data);
  std::string text;
  text.reserve((size + 2) / 3 * 4);
  for (std::size_t i = 0; i < size; i += 3) {
    const unsigned n = (b[i] << 16) | (i + 1 < size ? b[i + 1] << 8 : 0) | (i + 2 < size ? b[i + 2] : 0);
    for (int k = 3; k >= 0; --k) text += kDigits[(n >> (6 * k)) & 63];
  }
  for (std::size_t k = 1; k <= (3 - size % 3) % 3; ++k) text[text.size() - k] = '=';
  return text;
}

}  // namespace umtet
