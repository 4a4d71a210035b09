// Texts of motions from one form into another.
#include <doctest/doctest.h>

#include <motionlang/datasets/annotated_texts.hpp>
#include <motionlang/file/file.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

TEST_CASE("annotations become caption files") {
  const TemporaryFolder folder;
  const std::vector<ml::AnnotatedMotion> motions{
      {"a", "p/a", 4, {{"a_0", " walks ", 0, 4}, {"a_1", "waves", 1, 2}, {"a_2", "blinks", 3, 3}}},
      {"b", "p/b", 2, {{"b_0", "sits", 0, 2}}}};
  ml::write_annotations(folder / "all.json", motions);
  auto read = ml::read_annotated_texts(folder / "all.json");
  CHECK(read == motions);
  const auto captions = ml::captions_of(motions[0]);
  REQUIRE(captions.size() == 3);
  CHECK(captions[0].text == "walks");
  CHECK(captions[0].end == 0);  // the whole motion
  CHECK(captions[1].end == 2);
  CHECK(ml::drop_momentary_texts(read[0]) == 1);
  CHECK(ml::drop_momentary_texts(read[1]) == 0);
  const auto files = ml::caption_files(read);
  REQUIRE(files.size() == 2);
  CHECK(files.at("a.txt").find("walks") != std::string::npos);

  read[1].id = "a";
  CHECK_ERROR(ml::caption_files(read), "[motionlang.config.102]");
  ml::write_file(folder / "none.json", std::string_view("{}"));
  CHECK_ERROR(ml::read_annotated_texts(folder / "none.json"), "[motionlang.config.101]");
}

TEST_CASE("texts are converted by the name of the result, and lines report it") {
  const TemporaryFolder folder;
  const std::vector<ml::AnnotatedMotion> motions{
      {"a", "p/a", 4, {{"a_0", "walks", 0, 4}, {"a_1", "waves", 1, 2}, {"a_2", "blinks", 3, 3}}}};
  ml::write_annotations(folder / "in.json", motions);
  const std::string in = (folder / "in.json").string(), out = (folder / "out").string();
  CHECK(ml::convert_texts(in, out) ==
        in + ": 1 text of no duration is left out\n" + out + "/texts: 2 texts of 1 motion\n");
  CHECK(ml::read_file(folder / "out/texts/a.txt").find("waves") != std::string::npos);
  CHECK(ml::convert_texts(in, out + ".json") == out + ".json: 3 texts of 1 motion\n");
  CHECK(ml::read_annotated_texts(out + ".json") == motions);
  CHECK_ERROR(ml::convert_texts(in, out + ".txt"), "written to .json, or into a folder as caption files, not '.txt'");
  CHECK_ERROR(ml::convert_texts(in, in), "[motionlang.config.102]");
}
