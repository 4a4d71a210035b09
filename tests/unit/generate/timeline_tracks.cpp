#include <motionlang/generate/timeline_tracks.hpp>

#include <doctest/doctest.h>

namespace ml = motionlang;

TEST_CASE("a track for each text, in seconds, with its parts by name") {
  const auto parts = ml::BodyParts{}.with(ml::BodyPart::spine).with(ml::BodyPart::left_arm);
  const auto tracks = ml::timeline_tracks({{{"wave", 10, 30, parts}}}, 20);
  REQUIRE(tracks.size() == 1);
  CHECK(tracks[0].text == "wave");
  CHECK((tracks[0].start == 0.5 && tracks[0].end == 1.5));
  CHECK(tracks[0].parts == std::vector<std::string>{"left arm", "spine"});
  CHECK(ml::timeline_tracks({{{"walk", 0, 30, ml::BodyParts::all()}}}, 20)[0].parts ==
        std::vector<std::string>{"whole body"});
}
