// The gallery's page: self-contained, safe for any text, and with one figure for motions of one skeleton.
#include <motionlang/view/gallery_page.hpp>

#include <doctest/doctest.h>

#include <vector>

#include <motionlang/file/json.hpp>
#include <motionlang/view/viewer.hpp>

#include "../../support/markup.hpp"
#include "../../support/page_data.hpp"
#include "../../support/synthetic_motion.hpp"

namespace ml = motionlang;
using nlohmann::json;

TEST_CASE("a card for each motion; motions of one skeleton share its figure") {
  const ml::Motion walk = synthetic::walk({.frames = 40}), turn = synthetic::walk({.frames = 30, .turn = 1.0});
  const ml::Motion other = synthetic::walk({.frames = 20}, ml::humanml3d22_skeleton());
  const std::vector<ml::GalleryCard> cards{
      {walk, "walk", "walk forward"}, {other, "pace", "pace </script> & wait"}, {turn, "turn", "turn left"}};
  const std::string page = ml::gallery_html(cards, {.title = "All <verbs>", .info = "seed 0"});
  CHECK(page == ml::gallery_html(cards, {.title = "All <verbs>", .info = "seed 0"}));
  for (const char* word : {"http:", "https:", "src=", "href=", "@import", "url(", "import("})
    CHECK_MESSAGE(page.find(word) == std::string::npos, word);
  CHECK(page.find("<title>All &lt;verbs&gt;</title>") != std::string::npos);
  CHECK(occurrences(page, "</script>") == 2);  // of the data and of the program
  const json data = data_of(page);
  CHECK(data["info"] == "seed 0");
  REQUIRE(data["motions"].size() == 3);
  CHECK(data["figures"].size() == 2);
  CHECK(data["motions"][1]["name"] == "pace");
  CHECK(data["motions"][1]["note"] == "pace </script> & wait");
  const std::vector<int> figures{data["motions"][0]["figure"], data["motions"][1]["figure"],
                                 data["motions"][2]["figure"]};
  CHECK(figures == std::vector<int>{0, 1, 0});
  // Figure and motion together are what the viewer's page has of the same motion.
  json viewed = data_of(ml::viewer_html(other))["motions"][0], joined = data["motions"][1];
  for (const auto& [name, value] : data["figures"][1].items()) joined[name] = value;
  joined.erase("figure");
  joined["name"] = viewed["name"], joined["note"] = viewed["note"];
  CHECK(joined == viewed);
}

TEST_CASE("what cannot be shown in a gallery is an error") {
  CHECK_THROWS_WITH_AS(ml::gallery_html({}), doctest::Contains("gallery: no motion to show"), ml::config_error);
  ml::Motion empty = synthetic::walk({.frames = 1});
  empty.root.clear(), empty.local.clear();
  const std::vector<ml::GalleryCard> cards{{empty, "none", "none"}};
  CHECK_THROWS_WITH_AS(ml::gallery_html(cards), doctest::Contains("gallery: motion 'none' has no frames"),
                       ml::config_error);
}
