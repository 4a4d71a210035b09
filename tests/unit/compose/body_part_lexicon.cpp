// Guessed body parts.
#include <doctest/doctest.h>

#include <string>

#include <motionlang/compose/body_part_lexicon.hpp>

namespace ml = motionlang;

namespace {

/// "left arm + head"
std::string guess(std::string_view text) {
  const ml::BodyParts parts = ml::guess_body_parts(text);
  if (parts == ml::BodyParts::all()) return "all";
  std::string out;
  for (int p = 0; p < ml::body_part_count; ++p) {
    if (!parts.has(static_cast<ml::BodyPart>(p))) continue;
    out += (out.empty() ? "" : " + ") + std::string(ml::body_part_names[static_cast<std::size_t>(p)]);
  }
  return out;
}

}  // namespace

TEST_CASE("legs") {
  for (const char* text : {"walk", "walks forward", "Walking in a circle", "he stepped back", "jumps over a fence",
                           "kick with the right foot", "turn left", "RUNNING", "tiptoe", "hop on one leg"}) {
    CHECK_MESSAGE(guess(text) == "legs", text, ": ", guess(text));
  }
}

TEST_CASE("arms and their sides") {
  CHECK(guess("raising both hands") == "left arm + right arm");
  CHECK(guess("waves") == "right arm");
  CHECK(guess("wave with the left hand") == "left arm");
  CHECK(guess("waving with his right arm") == "right arm");
  CHECK(guess("points with left and right hand") == "left arm + right arm");
  CHECK(guess("clap") == "left arm + right arm");
  CHECK(guess("punch with the left fist") == "left arm");
  CHECK(guess("walk left and wave") == "right arm + legs");
  CHECK(guess("turn left, then raise the left arm") == "left arm + legs");
}

TEST_CASE("head, torso, everything, nothing known") {
  CHECK(guess("nods") == "head");
  CHECK(guess("look up") == "head");
  CHECK(guess("bend forward") == "spine");
  CHECK(guess("sit down") == "legs + spine");
  CHECK(guess("put on headphones") == "left arm + right arm + head");
  CHECK(guess("dancing wildly") == "all");
  CHECK(guess("cartwheels") == "all");
  CHECK(guess("handstand") == "all");  // the longest stem counts
  CHECK(guess("xyzzy") == "all");
  CHECK(guess("") == "all");
  CHECK(guess("\xFF 12 # !") == "all");
}

TEST_CASE("only missing parts are guessed") {
  ml::Timeline t{{{"walk", 0, 9, {}}, {"walk", 0, 9, ml::BodyParts{}.with(ml::BodyPart::head)}}};
  ml::guess_missing_parts(t);
  CHECK(t.intervals[0].parts == ml::BodyParts{}.with(ml::BodyPart::legs));
  CHECK(t.intervals[1].parts == ml::BodyParts{}.with(ml::BodyPart::head));
}
