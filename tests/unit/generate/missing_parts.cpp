// Body parts for texts of a timeline that name none.
#include <motionlang/generate/missing_parts.hpp>
#include <motionlang/generate/timelines_of_text.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;

TEST_CASE("texts without parts get those of the answers, else of their words; others keep theirs") {
  const std::string file = "wave # 0 # 2\nwalk # 0 # 4 # legs\nkick the ball # 2 # 4\n";
  auto timelines = ml::timelines_of_text(file);
  REQUIRE(timelines.size() == 1);
  CHECK(timelines[0].intervals[0].parts == ml::BodyParts::all());
  const ml::BodyPartAnswers answers{{"wave", "right arm\ntorso"}};
  const auto notes = ml::fill_missing_parts(timelines, file, &answers);
  const auto& i = timelines[0].intervals;
  CHECK(i[0].parts == ml::BodyParts{}.with(ml::BodyPart::right_arm).with(ml::BodyPart::spine).with(ml::BodyPart::head));
  CHECK(i[1].parts == ml::BodyParts{}.with(ml::BodyPart::legs));
  CHECK(i[2].parts == ml::BodyParts{}.with(ml::BodyPart::legs));
  REQUIRE(notes.size() == 2);
  CHECK(notes[0].find("'wave' moves ") == 0);
  CHECK(notes[0].find("by the answer of a language model") != std::string::npos);
  CHECK(notes[1].find("'kick the ball' moves legs, guessed from its words") == 0);

  auto guessed = ml::timelines_of_text(file);
  CHECK(ml::fill_missing_parts(guessed, file).size() == 2);
  CHECK(guessed[0].intervals[0].parts != ml::BodyParts::all());
  auto list = ml::timelines_of_text("wave # 2\nkick # 3\n");  // single texts move the whole body
  CHECK(ml::fill_missing_parts(list, "wave # 2\nkick # 3\n").empty());
  CHECK(list[0].intervals[0].parts == ml::BodyParts::all());
}

TEST_CASE("SINC's parts as STMC's: legs and pelvis are the legs") {
  using ml::SincPart;
  CHECK(ml::as_body_parts(ml::sinc_parts(SincPart::global)) == ml::BodyParts{}.with(ml::BodyPart::legs));
  CHECK(ml::as_body_parts(ml::sinc_parts(SincPart::left_arm, SincPart::left_leg)) ==
        ml::BodyParts{}.with(ml::BodyPart::left_arm).with(ml::BodyPart::legs));
  CHECK(ml::as_body_parts(~ml::SincParts{}) == ml::BodyParts::all());
}
