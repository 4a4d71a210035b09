// The page of ranked galleries: self-contained, safe for any text, and with every number.
#include <motionlang/view/retrieval_page.hpp>

#include <doctest/doctest.h>

#include "../../support/markup.hpp"

namespace ml = motionlang;

TEST_CASE("a section for each text, a picture for each motion, the own one marked") {
  const std::vector<ml::RankedQuery> queries{
      {"walk <fast> & \"turn\"",
       2,
       {{.number = 4, .id = "clip4", .text = "someone runs", .similarity = 0.9124, .text_similarity = 0.75},
        {.number = 7, .id = "a<b", .text = "walk", .similarity = 0.5, .text_similarity = 1, .own = true}}},
      {"sit", 1.5, {}}};
  std::vector<ml::Index> drawn;
  const std::string page = ml::retrieval_page(queries, "Nearest <of> 9", [&](const ml::RankedMotion& m) {
    drawn.push_back(m.number);
    return "<svg id=\"s" + std::to_string(m.number) + "\"></svg>";
  });
  CHECK(drawn == std::vector<ml::Index>{4, 7});
  for (const char* part :
       {"<title>Nearest &lt;of&gt; 9</title>", "“walk &lt;fast&gt; &amp; &quot;turn&quot;”", "own motion: 2<",
        "own motion: 1.5<", "0.912 · TS 0.75", "0.5 · TS 1<", "width:91.2%", "<svg id=\"s7\"></svg>", "a&lt;b"})
    CHECK_MESSAGE(page.find(part) != std::string::npos, part);
  CHECK(occurrences(page, "<section>") == 2);
  CHECK(occurrences(page, "<li class=\"own\">") == 1);
  for (const char* word : {"http:", "https:", "src=", "href=", "@import", "url(", "<script"})
    CHECK_MESSAGE(page.find(word) == std::string::npos, word);
  CHECK(ml::retrieval_page({}, "none", {}).find("There are no texts") != std::string::npos);
}
