// SPDX-License-Identifier: MIT
// Bodies of search_page.hpp.
#pragma once

#include <algorithm>   // clamp
#include <filesystem>  // names of files

#include <motionlang/core/formatted.hpp>
#include <motionlang/core/utf8.hpp>
#include <motionlang/file/detail/json_text.hpp>
#include <motionlang/formats/motion_folder.hpp>
#include <motionlang/kinematics/edit_motion.hpp>
#include <motionlang/view/detail/markup.hpp>
#include <motionlang/view/film_strip.hpp>
#include <motionlang/view/search_page.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The motion of a hit.
inline Motion found_motion(const FoundMotion& f, const MotionReadOptions& read) {
  for (const Motion& m : read_motions(f.clip.path, options_for_file(read, f.clip.path))) {
    if (f.clip.name.empty() || m.name == f.clip.name) return edit_time(m, {.from = f.start, .to = f.end});
  }
  raise<config_error>(103, f.clip.path, ": no motion '", f.clip.name, "' any more");
}

}  // namespace detail

MOTIONLANG_BODY std::vector<FoundMotion> found_motions(const IndexTables& index, const TextAnswer& answer) {
  std::vector<FoundMotion> out;
  for (std::size_t i = 0; i < answer.hits.size(); ++i) {
    const MotionHit& h = answer.hits[i];
    out.push_back({index.clip(h.clip), h.start, h.end, answer.scores[i], {}, {}});
  }
  return out;
}

MOTIONLANG_BODY std::string search_text(std::span<const FoundMotion> found, const TextAnswer& answer,
                                        std::string_view one) {
  std::string out;
  for (const UnknownWord& w : answer.unheard)
    out += concat_text("the model does not know the word '", printable(w.word), "'",
                       w.like.empty() ? "" : " (did you mean '" + w.like + "'?)", "\n");
  if (!answer.shown) out += concat_text("no ", one, " shows this", found.empty() ? "" : "; the nearest are:", "\n");
  int place = 0;
  for (const FoundMotion& f : found) {
    out += formatted("%3d  %.*f  %7.2f %7.2f s  ", ++place, answer.calibrated ? 4 : 3, f.score, f.start, f.end);
    out += printable(f.clip.path);
    if (!f.clip.name.empty()) out += " (" + printable(f.clip.name) + ")";
    if (!f.clip.captions.empty()) out += "  \"" + printable(f.clip.captions.front()) + "\"";
    out += "\n";
  }
  return out;
}

MOTIONLANG_BODY std::string search_json(std::span<const FoundMotion> found, const TextAnswer& answer,
                                        std::string_view query, std::string_view kind) {
  auto hits = nlohmann::ordered_json::array(), unheard = nlohmann::ordered_json::array();
  for (const FoundMotion& f : found)
    hits.push_back({{"path", f.clip.path},
                    {"name", f.clip.name},
                    {"start", f.start},
                    {"end", f.end},
                    {"score", f.score},
                    {"captions", f.clip.captions},
                    {"license", f.clip.license}});
  for (const UnknownWord& w : answer.unheard) unheard.push_back(w.word);
  const nlohmann::ordered_json out{{"query", std::string(query)},
                                   {"kind", std::string(kind)},
                                   {"shown", answer.shown},
                                   {"unknown_words", std::move(unheard)},
                                   {"hits", std::move(hits)}};
  return detail::json_text(out, 2) + "\n";
}

MOTIONLANG_BODY void draw_found(std::span<FoundMotion> found, const MotionReadOptions& read) {
  for (FoundMotion& f : found) {
    const std::string title =
        f.clip.name.empty() ? std::filesystem::path(f.clip.path).filename().string() : f.clip.name;
    detail::guard<error>([&] { f.strip = film_strip_svg(detail::found_motion(f, read), {}, {.title = title}); },
                         [&](const error& e) {
                           f.problem = e.what();
                           return true;
                         });
  }
}

MOTIONLANG_BODY std::string search_html(std::span<const FoundMotion> found, std::string_view query,
                                        std::string_view summary) {
  using detail::escape_markup, detail::fixed;
  std::string out = concat_text(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
      "'unsafe-inline'\">\n<title>",
      escape_markup(query), "</title>\n<style>body{font:15px/1.45 system-ui,-apple-system,'Segoe UI',sans-serif;",
      "color:#20242c;max-width:1330px;margin:2em auto;padding:0 1em}h1{font-size:1.5em;margin-bottom:.1em}",
      "h2{font-size:1.05em;margin:0;overflow-wrap:anywhere}section{margin:1.8em "
      "0}header{display:flex;gap:1em;align-items:baseline}",
      ".score{font-variant-numeric:tabular-nums;font-weight:600;min-width:3.2em}",
      ".bar{display:inline-block;height:.6em;border-radius:.3em;background:#2b6cb0;margin-right:.6em}",
      ".about{color:#5b6472;margin:.1em 0 .5em}.problem{color:#a3380e}",
      "svg{max-width:100%;height:auto;border:1px solid #e1e5ea;border-radius:6px}</style>\n</head>\n<body>\n<h1>",
      escape_markup(query), "</h1>\n<p class=\"about\">", escape_markup(summary), "</p>\n");
  int place = 0;
  for (const FoundMotion& f : found) {
    std::string about = concat_text(fixed(f.start, 2), " to ", fixed(f.end, 2), " s");
    if (!f.clip.name.empty()) about += " of " + f.clip.name;
    for (const std::string& c : f.clip.captions) about += " · “" + c + "”";
    if (!f.clip.license.empty()) about += " · " + f.clip.license;
    out += concat_text(
        "<section>\n<header><span class=\"score\">", fixed(f.score, 3), "</span><h2>", ++place, ". ",
        escape_markup(f.clip.path), "</h2></header>\n<p class=\"about\"><span class=\"bar\" style=\"width:",
        fixed(12 * std::clamp(f.score, 0.0, 1.0), 2), "em\"></span>", escape_markup(about), "</p>\n", f.strip);
    if (!f.problem.empty()) out += concat_text("<p class=\"problem\">", escape_markup(f.problem), "</p>\n");
    out += "</section>\n";
  }
  if (found.empty()) out += "<p>Nothing was found.</p>\n";
  return out + "</body>\n</html>\n";
}

MOTIONLANG_NAMESPACE_END
