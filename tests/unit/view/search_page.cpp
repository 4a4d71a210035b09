// The page of a search: what is on it, and that nothing in a name becomes markup.
#include <doctest/doctest.h>

#include <motionlang/file/json.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/kinematics/edit_motion.hpp>
#include <motionlang/view/film_strip.hpp>
#include <motionlang/view/search_page.hpp>

#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

TEST_CASE("draw_found: a strip of the part that was found, or why there is none") {
  const TemporaryFolder folder;
  ml::write_bvh(folder / "walk.bvh", synthetic::walk({.frames = 40}));
  const std::string walk = (folder / "walk.bvh").string();
  std::vector<ml::FoundMotion> found(4);
  found[0] = {.clip = {.path = walk}, .start = 0.5, .end = 1};
  found[1] = {.clip = {.path = walk, .name = "run"}, .end = 1};
  found[2] = {.clip = {.path = walk}, .start = 9, .end = 10};
  found[3] = {.clip = {.path = (folder / "gone.bvh").string()}, .end = 1};
  ml::draw_found(found);
  const auto part = ml::edit_time(ml::read_motion(walk), {.from = 0.5, .to = 1});
  CHECK(found[0].strip == ml::film_strip_svg(part, {}, {.title = "walk.bvh"}));
  CHECK(found[0].problem.empty());
  CHECK(found[1].problem.find("no motion 'run' any more") != std::string::npos);
  CHECK(found[2].problem.find("nothing of its 2 s is between 9 and 10 s") != std::string::npos);
  CHECK(found[3].problem.find("[motionlang.io.401]") != std::string::npos);
  for (std::size_t i = 1; i < found.size(); ++i) CHECK(found[i].strip.empty());
}

TEST_CASE("search_html: scores, places, what is said about a clip, its strip, or why there is none") {
  std::vector<ml::FoundMotion> found(2);
  found[0] = {.clip = {.path = "clips/<walk>.bvh", .captions = {"a \"person\" walks"}, .license = "CC0 1.0"},
              .start = 1.5,
              .end = 2.75,
              .score = 0.625,
              .strip = ml::film_strip_svg(synthetic::walk({.frames = 20}))};
  found[1] = {.clip = {.path = "b.glb", .name = "wave"}, .end = 3, .score = 2, .problem = "cannot open b.glb"};
  const std::string page = ml::search_html(found, "walks & waves", "The nearest 2 of 10");
  for (const std::string part : {"<title>walks &amp; waves</title>", "The nearest 2 of 10", "1. clips/&lt;walk&gt;.bvh",
                                 "0.625", "1.5 to 2.75 s", "a &quot;person&quot; walks", "CC0 1.0", "<svg", "2. b.glb",
                                 "0 to 3 s of wave", "width:7.5em", "width:12em", "cannot open b.glb"})
    CHECK_MESSAGE(page.find(part) != page.npos, part);
  CHECK(page.find("<walk>") == page.npos);
  CHECK(page.find("https://") == page.npos);
  CHECK(page.find("http://") == page.find("http://www.w3.org"));  // the name space of SVG
  CHECK(ml::search_html({}, "nothing", "").find("Nothing was found.") != std::string::npos);
}

TEST_CASE("results are lines, or JSON") {
  ml::TextAnswer answer;
  answer.calibrated = true, answer.shown = false, answer.unheard = {{.word = "wlak", .like = "walk"}};
  std::vector<ml::FoundMotion> found(2);
  found[0] = {.clip = {.path = "a.bvh", .captions = {"a \"person\" walks", "walks"}, .license = "CC0 1.0"},
              .start = 1.5,
              .end = 2.75,
              .score = 0.625};
  found[1] = {.clip = {.path = "b\n.glb", .name = "wave"}, .end = 3, .score = 0.5};
  CHECK(ml::search_text(found, answer, "clip") ==
        "the model does not know the word 'wlak' (did you mean 'walk'?)\nno clip shows this; the nearest are:\n"
        "  1  0.6250     1.50    2.75 s  a.bvh  \"a \"person\" walks\"\n"
        "  2  0.5000     0.00    3.00 s  b?.glb (wave)\n");
  CHECK(ml::search_text({}, {}, "moment").empty());
  const auto read = nlohmann::json::parse(ml::search_json(found, answer, "wlak", "clips"));
  CHECK(read["query"] == "wlak");
  CHECK(read["shown"] == false);
  CHECK(read["unknown_words"][0] == "wlak");
  REQUIRE(read["hits"].size() == 2);
  CHECK(read["hits"][0]["captions"][1] == "walks");
  CHECK(read["hits"][1]["path"] == "b\n.glb");
}
