// SPDX-License-Identifier: MIT
// Bodies of retrieval_page.hpp.
#pragma once

#include <algorithm>  // clamp

#include <motionlang/view/detail/markup.hpp>
#include <motionlang/view/retrieval_page.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr std::string_view retrieval_style = R"(
:root{color-scheme:light dark;--ink:#20242c;--soft:#5b6472;--line:#d9dee5;--back:#fff;--right:#1f7a4d;--bar:#2b6cb0}
@media (prefers-color-scheme:dark){:root{--ink:#e6e9ee;--soft:#a2abb8;--line:#3a424d;--back:#15181d;--right:#5cc793;
--bar:#6ea8e0}}
body{font:15px/1.45 system-ui,-apple-system,'Segoe UI',sans-serif;color:var(--ink);background:var(--back);
max-width:1400px;margin:2em auto;padding:0 1em}
h1{font-size:1.4em;margin:0}h2{font-size:1.1em;margin:0;overflow-wrap:anywhere}
.about{color:var(--soft);margin:.1em 0 .6em}
section{margin:2em 0;border-top:1px solid var(--line);padding-top:1em}
ol{list-style:none;margin:0;padding:0;display:grid;grid-template-columns:repeat(auto-fill,minmax(14em,1fr));gap:1em}
li{border:1px solid var(--line);border-radius:8px;padding:.6em;min-width:0}
li.own{border:2px solid var(--right);padding:calc(.6em - 1px)}
.place{font-weight:600}.own .place::after{content:" own motion";color:var(--right)}
.number{font-variant-numeric:tabular-nums}
.bar{display:block;height:.4em;border-radius:.2em;background:var(--bar);margin:.15em 0 .4em}
li p{margin:.3em 0 0;overflow-wrap:anywhere}li .id{color:var(--soft);font-size:.85em}
li svg{display:block;width:100%;height:auto;background:#fff;border-radius:4px}
)";

}  // namespace detail

MOTIONLANG_BODY std::string retrieval_page(std::span<const RankedQuery> queries, std::string_view title,
                                           const std::function<std::string(const RankedMotion&)>& strip) {
  using detail::escape_markup, detail::fixed;
  std::string out = concat_text(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'\">\n"
      "<title>",
      escape_markup(title), "</title>\n<style>", detail::retrieval_style, "</style>\n</head>\n<body>\n<h1>",
      escape_markup(title),
      "</h1>\n<p class=\"about\">Each text with its nearest motions. The bar is the similarity of motion and text; TS "
      "is "
      "the similarity of the motion's own text to the query.</p>\n");
  for (const RankedQuery& q : queries) {
    out += concat_text("<section>\n<h2>“", escape_markup(q.text),
                       "”</h2>\n<p class=\"about\">rank of its own motion: ", fixed(q.rank, 1), "</p>\n<ol>\n");
    int place = 0;
    for (const RankedMotion& m : q.motions) {
      out +=
          concat_text("<li", m.own ? " class=\"own\"" : "", "><span class=\"place\">", ++place,
                      "</span> <span class=\"number\">", fixed(m.similarity, 3), " · TS ", fixed(m.text_similarity, 2),
                      "</span><span class=\"bar\" style=\"width:", fixed(100 * std::clamp(m.similarity, 0.0, 1.0), 1),
                      "%\"></span>", strip(m), "<p>", escape_markup(m.text), "</p><p class=\"id\">",
                      escape_markup(m.id), "</p></li>\n");
    }
    out += "</ol>\n</section>\n";
  }
  if (queries.empty()) out += "<p>There are no texts.</p>\n";
  return out + "</body>\n</html>\n";
}

MOTIONLANG_NAMESPACE_END
