// The texts of a timeline as one sentence.
#include <motionlang/generate/joined_timeline.hpp>

#include <doctest/doctest.h>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

TEST_CASE("a timeline's texts become one, from its first frame to its end") {
  const ml::BodyParts legs = ml::BodyParts{}.with(*ml::parse_body_part("legs"));
  const ml::Timeline timeline{{{"walk", 3, 40, legs}, {"wave", 0, 55, ml::BodyParts::all()}}};
  for (const auto& [conjunction, sentence] : {std::pair(ml::Conjunction::while_, "walk while wave"),
                                              {ml::Conjunction::same_time, "walk and wave at the same time"},
                                              {ml::Conjunction::comma, "walk, wave"}}) {
    const auto joined = ml::joined_timeline(timeline, ml::LabelSentences(conjunction));
    REQUIRE(joined.intervals.size() == 1);
    const auto& one = joined.intervals[0];
    CHECK(one.text == sentence);
    CHECK((one.start == 0 && one.end == 55 && one.parts == ml::BodyParts::all()));
  }
  const TemporaryFolder folder;
  ml::write_file(folder / "tags.txt", std::string_view("walk while wave#walk/VERB while/SCONJ wave/VERB#0.0#0.0\n"));
  const ml::LabelSentences tagged(ml::Conjunction::while_, folder / "tags.txt");
  CHECK(ml::joined_timeline(timeline, tagged).intervals[0].text == "walk while waveing");
  CHECK_ERROR(ml::joined_timeline({{{"sit", 0, 9, legs}, {"wave", 0, 9, legs}}}, tagged), "[motionlang.config.103]");
  CHECK(ml::joined_timeline({}, tagged).intervals.empty());
}
