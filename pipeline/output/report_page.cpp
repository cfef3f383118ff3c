#include "pipeline/output/report_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <optional>
#include <sstream>
#include <stdexcept>

#include "pipeline/output/detail/report_sources.h"

namespace umtet {
namespace {

std::string dumped(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

std::string thousands(const std::string& digits) {
  std::string s = digits;
  for (int k = static_cast<int>(s.size()) - 3; k > 0; k -= 3) s.insert(s.begin() + k, ',');
  return s;
}

/// Returns a value of the certificate, marked with its position in certificate.json.
std::string marked(const char* pointer, const std::string& text) {
  return fmt::format("<span data-certificate=\"{}\">{}</span>", pointer, text);
}

template <std::integral Count>
std::string value(const char* pointer, Count n) {
  return marked(pointer, n < 0 ? fmt::format("{}", n) : thousands(fmt::format("{}", n)));
}

std::string value(const char* pointer, const std::optional<double>& number, int digits = 4) {
  return marked(pointer, number && !std::isnan(*number) ? fmt::format("{:.{}g}", *number, digits) : "–");
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

std::string reason_list(const Certificate& certificate) {
  const std::vector<std::string>& accepted = certificate.verdict.accepted;
  const std::vector<std::string>& defects = certificate.verdict.defects;
  if (certificate.verdict.passes() && accepted.empty() && defects.empty()) return "";
  std::string out = "<ul class=\"reasons\">\n";
  for (const std::string& reason : certificate.verdict.reasons) out += "<li>" + html_text(reason) + "</li>\n";
  for (const std::string& what : accepted) out += "<li>Accepted: " + html_text(what) + "</li>\n";
  for (const std::string& what : defects) out += "<li>Defect: " + html_text(what) + "</li>\n";
  if (const std::optional<Blame>& blame = certificate.blame) {
    out += "<li>Cause: " + html_text(blame->stage) + " (" + html_text(blame->number) + "). Try " +
           html_text(blame->remedy) + ".</li>\n";
  }
  return out + "</ul>";
}

std::string check_list(const Certificate& c) {
  std::string out;
  const auto add = [&](const std::string& words, std::optional<bool> holds) {
    out += fmt::format("<li class=\"{}\">{}</li>\n", !holds ? "open" : *holds ? "good" : "bad", words);
  };
  const MeshCertificate& mesh = c.measured.mesh;
  add("inverted tets: " + value("/quality/n_inverted", mesh.quality.n_inverted), mesh.quality.n_inverted == 0);
  add("closed manifold boundary", mesh.boundary.closed_manifold);
  add("boundary free of self-intersections", mesh.boundary.n_self_intersections == 0);
  add("the boundary is the surface to be fitted", mesh.boundary.equals_positive_faces);
  // A statement that cannot be proved is open, not wrong.
  const bool proved = c.measured.domain.components_proved.value_or(false);
  add("all components of ψ = 0 proved to be found", proved ? std::optional(true) : std::nullopt);
  if (const std::optional<double>& gap = mesh.boundary.gap_over_volume) {
    const double most = c.verdict.volume_gap_gate;
    add(fmt::format("volume between faces and ψ = 0 at most {:.3g} % of the volume", 100 * most), *gap <= most);
  }
  if (const std::optional<SupportReport>& support = c.measured.domain.support; support && support->n_closed_holes > 0) {
    add(fmt::format("<a href=\"#holes\">holes closed without samples: {}</a>",
                    value("/domain/n_closed_holes", support->n_closed_holes)),
        std::nullopt);
  }
  if (const std::optional<SampleDistances>& cloud = c.measured.cloud; cloud && cloud->n_missed_places > 0) {
    add(fmt::format("<a href=\"#missed\">places where the mesh misses samples: {}</a>",
                    value("/cloud/n_missed_places", cloud->n_missed_places)),
        std::nullopt);
  }
  if (const std::optional<FeatureReport>& f = c.measured.features) {
    add(fmt::format("sharp edges and corners in the mesh, of {} and {}", value("/features/curves", f->n_curves),
                    value("/features/corners", f->n_corners)),
        f->has_all()         ? std::optional(true)
        : c.verdict.fits_psi ? std::nullopt
                             : std::optional(false));
  }
  const DefectReport& defects = c.measured.defects;
  if (const std::size_t n = defects.n(); n > 0) {
    add(fmt::format("<a href=\"#places\">defects, where the mesh is not ψ = 0: {}</a>", value("/places/n", n)),
        c.verdict.fits_psi ? std::optional<bool>() : false);
  }
  add("fits ψ", c.verdict.fits_psi);
  if (has_input(c.measured)) add("fits the input", c.verdict.fits_input);
  if (const std::optional<double>& gate = c.verdict.min_quality_gate) {
    add("min Q at least " + value("/gates/min_quality", gate, 6), mesh.quality.min >= *gate);
  } else {
    add("no gate on min Q", std::nullopt);
  }
  return out;
}

std::string headline_cards(const Certificate& c) {
  std::string out;
  const auto card = [&](const std::string& big, const std::string& small) {
    out += "<div class=\"card\"><b>" + big + "</b><span>" + small + "</span></div>\n";
  };
  const MeshCertificate& mesh = c.measured.mesh;
  const MeshCertificate::Quality& q = mesh.quality;
  const MeshCertificate::Boundary& b = mesh.boundary;
  const std::string units = c.units ? " " + html_text(*c.units) : "";
  card(value("/n_tets", mesh.n_tets), "tets, " + value("/n_vertices", mesh.n_vertices) + " vertices");
  card(value("/quality/min", q.min), "min mean ratio Q; 1&nbsp;%: " + value("/quality/p01", q.p01));
  card(value("/quality/dihedral_min_deg", q.dihedral_min_deg, 3) + "–" +
           value("/quality/dihedral_max_deg", q.dihedral_max_deg) + "°",
       "dihedral angles");
  if (const std::optional<SizesReport>& sizes = c.measured.sizes) {
    card(value("/sizes/shortest_boundary_edge", sizes->shortest_boundary_edge, 3) + "–" +
             value("/sizes/longest_boundary_edge", sizes->longest_boundary_edge, 3) + units,
         "edges of the boundary; half of all edges are shorter than " +
             value("/sizes/edge_over_asked/p50", sizes->p50, 3) + " of the requested size");
  } else {
    card(value("/h", mesh.h) + units, "edge length h of the background");
  }
  card(value("/boundary/n_faces", b.n_faces), "boundary faces; genus " + value("/boundary/genus", b.genus) +
                                                  ", components " + value("/boundary/components", b.components));
  card(value("/boundary/max_centroid_distance_over_h", b.max_centroid_distance_over_h, 3) + " h",
       "face centres off ψ&nbsp;=&nbsp;0; vertices " +
           value("/boundary/max_vertex_distance_over_h", b.max_vertex_distance_over_h, 2) + " h");
  if (const std::optional<SampleDistances>& cloud = c.measured.cloud) {
    card(value("/cloud/p99_distance_over_h", cloud->p99 / mesh.h, 3) + " h",
         "distance of 99&nbsp;% of the samples; max " + value("/cloud/max_distance_over_h", cloud->max / mesh.h, 3) +
             " h");
  }
  if (const std::optional<FeatureReport>& f = c.measured.features) {
    card(value("/features/curves", f->n_curves),
         "sharp edges, " + value("/features/corners", f->n_corners) + " corners, " +
             value("/features/patches", f->n_patches) + " patches; angles off by at most " +
             value("/features/max_angle_off_deg", f->max_angle_off_deg, 2) + "°; best possible Q at them " +
             value("/features/wedge_quality", f->wedge_quality, 3));
  }
  if (const std::optional<TriangleDistances>& given = c.measured.triangles) {
    card(value("/triangles/max_distance_over_h", given->max_over_h, 3) + " h",
         "maximum distance from the mesh to the given triangles; from them to the mesh " +
             value("/triangles/max_distance_back_over_h", given->max_back_over_h, 3) + " h");
  }
  return out;
}

std::string stage_table(const std::vector<StageRecord>& records) {
  double total = 0;
  for (const StageRecord& r : records) total += r.run.seconds;
  std::string rows = "<tr><th>stage</th><th>seconds</th><th></th><th>peak memory, MB</th><th>threads</th></tr>\n";
  for (const StageRecord& r : records) {
    const double s = r.run.seconds;
    rows += fmt::format(
        "<tr><td>{}</td><td>{:.3g}</td><td class=\"bar\"><i style=\"width:{:.1f}%\"></i></td><td>{:.0f}</td>"
        "<td>{}</td></tr>\n",
        html_text(to_string(r.stage)), s, total > 0 ? 100 * s / total : 0, r.run.peak_memory_MB, r.run.threads);
  }
  return "<div class=\"table\"><h2>time and memory of the stages</h2>\n<table>\n" + rows + "</table></div>\n";
}

std::string band_table(const std::vector<BandReport>& bands) {
  if (bands.empty()) return "";
  std::string rows =
      "<tr><th>spacing</th><th>samples</th><th>nodes</th><th>iterations</th><th>relative residual</th></tr>\n";
  for (const BandReport& b : bands) {
    rows += fmt::format("<tr><td>{:.4g}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.2e}</td></tr>\n", b.spacing,
                        b.n_samples, b.n_nodes, b.iterations, b.residual);
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

std::string report_page(std::map<std::string, std::string> parts) {
  parts.insert({{"css", std::string(report_page_css())},
                {"js", fmt::format("{}{}{}", report_scenes_js(), report_view_js(), report_viewer_js())},
                {"three", std::string(report_three_js())},
                {"certificate", "null"},
                {"scene", "null"}});
  for (const char* name : {"checksum", "patch_settings", "verdict", "verdict_mark", "made", "reasons", "checks",
                           "cards", "shown", "places", "holes", "missed", "figures", "tables", "blocks"})
    parts.try_emplace(name);
  return filled(report_page_html(), parts);
}

std::string blocks_text(const std::vector<std::pair<std::string, std::string>>& blocks) {
  std::string text;
  for (const auto& [name, base64] : blocks)
    text += fmt::format("<script type=\"text/plain\" id=\"block-{}\">{}</script>\n", name, base64);
  return text;
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
