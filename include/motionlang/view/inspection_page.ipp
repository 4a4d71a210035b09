// SPDX-License-Identifier: MIT
// Bodies of inspection_page.hpp.
#pragma once

#include <algorithm>  // count_if

#include <motionlang/view/detail/markup.hpp>
#include <motionlang/view/inspection_page.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::array<Index, fault_info.size()> count_faults(std::span<const InspectedMotion> motions) {
  std::array<Index, fault_info.size()> count{};
  for (const InspectedMotion& m : motions) {
    for (const Finding& f : m.findings) ++count[static_cast<std::size_t>(f.fault)];
  }
  return count;
}

MOTIONLANG_BODY std::string inspection_html(std::span<const InspectedMotion> motions, std::string_view title) {
  using detail::escape_markup;
  const auto total = std::ssize(motions);
  const auto good = std::count_if(motions.begin(), motions.end(), [](const auto& m) { return m.good(); });
  const auto unreadable =
      std::count_if(motions.begin(), motions.end(), [](const auto& m) { return !m.unreadable.empty(); });
  std::string out = concat_text(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
      "'unsafe-inline'\">\n<title>",
      escape_markup(title), "</title>\n<style>body{font:15px/1.45 system-ui,-apple-system,'Segoe UI',sans-serif;",
      "color:#20242c;max-width:1330px;margin:2em auto;padding:0 1em}table{border-collapse:collapse;margin:1em 0}",
      "td,th{text-align:left;padding:.25em 1em .25em 0;border-bottom:1px solid #e1e5ea;vertical-align:top}",
      "td.n,th.n{text-align:right}h1{font-size:1.5em}h2{font-size:1.05em;margin:1.6em 0 .2em}",
      ".about{color:#5b6472;font-weight:400}ul{margin:.2em 0 .4em;padding-left:1.3em}b{font-weight:600;color:#a3380e}",
      "svg{max-width:100%;height:auto;border:1px solid #e1e5ea;border-radius:6px}</style>\n</head>\n<body>\n<h1>",
      escape_markup(title), "</h1>\n<p>", counted(total, "motion"), ": ", good, " without a finding, ",
      total - good - unreadable, " with findings, ", unreadable, " unreadable.</p>\n");
  if (good < total) {
    out += "<table>\n<tr><th>finding</th><th class=\"n\">motions</th><th>meaning</th><th>mended</th></tr>\n";
    const auto count = count_faults(motions);
    for (std::size_t i = 0; i < count.size(); ++i) {
      if (count[i] == 0) continue;
      out += concat_text("<tr><td>", fault_info[i].name, "</td><td class=\"n\">", count[i], "</td><td>",
                         fault_info[i].meaning, "</td><td>", fault_info[i].mendable ? "yes" : "no", "</td></tr>\n");
    }
    out += "</table>\n";
  }
  for (const InspectedMotion& m : motions) {
    if (m.good()) continue;
    out += concat_text("<h2>", escape_markup(m.name), " <span class=\"about\">", escape_markup(m.about),
                       "</span></h2>\n<ul>\n");
    if (!m.unreadable.empty()) out += concat_text("<li><b>unreadable</b>: ", escape_markup(m.unreadable), "</li>\n");
    for (const Finding& f : m.findings) {
      out += concat_text("<li><b>", info(f.fault).name, "</b>: ", escape_markup(f.text), "</li>\n");
    }
    out += concat_text("</ul>\n", m.strip);
  }
  return out + "</body>\n</html>\n";
}

MOTIONLANG_NAMESPACE_END
