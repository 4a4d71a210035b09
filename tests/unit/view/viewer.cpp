// The viewer's page: self-contained, small, safe for any text, and with the motion in it. What it does in a browser is
// tested in tests/browser.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/json.hpp>
#include <motionlang/view/detail/viewer_page.hpp>
#include <motionlang/view/viewer.hpp>

#include "../../support/markup.hpp"
#include "../../support/page_data.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using nlohmann::json;

namespace {

/// The motion as the page's program decodes it.
ml::Motion decoded(const json& entry) {
  ml::Motion motion;
  for (std::size_t j = 0; j < entry["parents"].size(); ++j) {
    const json& o = entry["offsets"][j];
    motion.skeleton.names.push_back("joint" + std::to_string(j));
    motion.skeleton.parents.push_back(entry["parents"][j]);
    motion.skeleton.offsets.push_back({o[0], o[1], o[2]});
  }
  motion.fps = entry["fps"];
  const auto bytes = ml::detail::from_base64(entry["data"].get<std::string>());
  std::uint64_t at = 0;
  for (int frame = 0; frame < entry["frames"]; ++frame, at += 12) {
    motion.root.push_back(ml::vec_cast<double>(ml::detail::load<ml::Vec3<float>>(bytes, at, "", "")));
  }
  for (; at < bytes.size(); at += 8) {
    double q[4];
    for (std::uint64_t i = 0; i < 4; ++i) q[i] = ml::detail::load<std::int16_t>(bytes, at + 2 * i, "", "");
    motion.local.push_back(ml::normalized(ml::Quaternion<double>{q[3], q[0], q[1], q[2]}));
  }
  motion.validate();
  return motion;
}

}  // namespace

TEST_CASE("the motion is in the page to a tenth of a millimetre") {
  for (const int frames : {1, 60}) {
    const ml::Motion motion = synthetic::walk({.frames = frames, .turn = 0.7});
    const json data = data_of(ml::viewer_html(motion));
    const ml::Motion back = decoded(data["motions"][0]);
    CHECK(back.fps == motion.fps);
    const auto p = motion.positions(), q = back.positions();
    REQUIRE(p.size() == q.size());
    for (std::size_t i = 0; i < p.size(); ++i) CHECK(ml::norm(p[i] - q[i]) < 1e-4);
    CHECK(data["motions"][0]["floor"].get<double>() == doctest::Approx(0).epsilon(0.05));
  }
}

TEST_CASE("the floor is where the figure stands, not the lowest point that a foot ever touches") {
  ml::Motion motion = synthetic::walk({.frames = 60});
  auto floor = [&] { return data_of(ml::viewer_html(motion))["motions"][0]["floor"].get<double>(); };
  const double standing = floor();
  motion.root[20].y -= 0.2;
  CHECK(std::abs(floor() - standing) < 0.005);
  for (auto& root : motion.root) root.y += 1;
  CHECK(std::abs(floor() - standing - 1) < 0.005);
}

TEST_CASE("one file that asks for nothing, and small") {
  const TemporaryFolder folder;
  const ml::Motion motion = synthetic::walk({.frames = 600, .fps = 60});  // ten seconds
  ml::write_viewer(folder / "walk.html", motion, {}, {.title = "Walk", .info = "model, seed 7"});
  const std::string page = ml::read_file(folder / "walk.html");
  CHECK(page.size() < 400'000);
  CHECK(ml::viewer_html(synthetic::walk({.frames = 200})).size() < 120'000);
  const std::size_t data = page.find("id=\"data\""), end = page.find("</script>", data);
  CHECK(data + page.size() - end < 40'000);  // without the motion
  for (const char* word : {"http:", "https:", "src=", "href=", "@import", "url(", "import("}) {
    CHECK_MESSAGE(page.find(word) == std::string::npos, word);
  }
  CHECK(page.find("Content-Security-Policy\" content=\"default-src 'none';") != std::string::npos);
  CHECK(page.find("<title>Walk</title>") != std::string::npos);
  CHECK(data_of(page)["info"] == "model, seed 7");
  CHECK(page == ml::viewer_html(motion, {}, {.title = "Walk", .info = "model, seed 7"}));
}

TEST_CASE("texts cannot become markup") {
  const std::vector<ml::Track> tracks{{"</script><script>alert(1)</script> <!-- \xFF", 0, 1, {"legs"}}};
  const std::string page = ml::viewer_html(synthetic::walk({.frames = 2}), tracks, {.title = "</title><b>&"});
  CHECK(occurrences(page, "</script>") == 2);  // of the data and of the program
  CHECK(occurrences(page, "<!--") == 0);
  CHECK(page.find("<title>&lt;/title&gt;&lt;b&gt;&amp;</title>") != std::string::npos);
  const json track = data_of(page)["motions"][0]["tracks"][0];
  CHECK(track["text"] == "</script><script>alert(1)</script> <!-- \uFFFD");
  CHECK(track["parts"] == json::array({"legs"}));
}

TEST_CASE("several motions, any skeleton") {
  const ml::Skeleton one = ml::Skeleton::from_joints({{"only", "", {0, 1, 0}}});
  const std::vector<ml::ViewerMotion> motions{{synthetic::walk({.frames = 5}), {{"walk", 0, 1}}, "first"},
                                              {{one, 25, {{0, 1, 0}}, {ml::Quaternion<double>::identity()}, "ball"}}};
  const json data = data_of(ml::viewer_html(motions));
  CHECK(data["title"] == "walk");
  REQUIRE(data["motions"].size() == 2);
  CHECK(data["motions"][0]["note"] == "first");
  CHECK(data["motions"][1]["name"] == "ball");
  CHECK(data["motions"][1]["cones"].size() == 1);
  CHECK(decoded(data["motions"][1]).root_at(0).y == 1);
}

TEST_CASE("what cannot be shown is an error") {
  CHECK_THROWS_WITH_AS(ml::viewer_html(std::vector<ml::ViewerMotion>{}), doctest::Contains("101"), ml::config_error);
  ml::Motion motion = synthetic::walk({.frames = 2});
  const std::vector<ml::Track> endless{{"forever", 0, std::numeric_limits<double>::infinity()}};
  CHECK_THROWS_WITH_AS(ml::viewer_html(motion, endless), doctest::Contains("101"), ml::config_error);
  ml::Motion far = motion;
  far.root[0].z = -1e39;
  CHECK_THROWS_WITH_AS(ml::viewer_html(far), doctest::Contains("too far to be drawn"), ml::numeric_error);
  motion.local[5].w = std::nan("");
  CHECK_THROWS_WITH_AS(ml::viewer_html(motion), doctest::Contains("301"), ml::numeric_error);
  motion.root.clear();
  motion.local.clear();
  CHECK_THROWS_WITH_AS(ml::viewer_html(motion), doctest::Contains("101"), ml::config_error);
}
