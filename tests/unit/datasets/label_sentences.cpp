// Labels as sentences, with the -ing form of the second verb where a file says what the verbs are.
#include <doctest/doctest.h>

#include <motionlang/datasets/label_sentences.hpp>
#include <motionlang/file/file.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

TEST_CASE("labels become sentences; tagged words give the second verb its -ing form") {
  const TemporaryFolder folder;
  ml::write_file(folder / "tags.txt", std::string_view("walk while wave#walk/VERB while/SCONJ wave/VERB#0.0#0.0\n"));
  const std::vector<std::string> labels{"walk", "wave"}, others{"sit", "wave"};
  const ml::LabelSentences plain(ml::Conjunction::while_);
  CHECK(plain(labels) == "walk while wave");
  CHECK(!plain.has_tags());
  CHECK(ml::LabelSentences(ml::Conjunction::same_time)(labels) == "walk and wave at the same time");
  const ml::LabelSentences tagged(ml::Conjunction::while_, folder / "tags.txt");
  CHECK(tagged.has_tags());
  CHECK(tagged(labels) == "walk while waveing");  // naive, as published
  CHECK_ERROR(tagged(others), "no words of 'sit while wave'");

  const ml::DescribedMotion known{"a", "a", {}, {{"walk", {}}, {"wave", {}}}},
      unknown{"b", "b", {}, {{"sit", {}}, {"wave", {}}}};
  tagged.require({&known});
  plain.require({&unknown});
  CHECK_ERROR(tagged.require({&known, &unknown, &unknown}), "no words of 1 sentence:\nsit while wave");
  CHECK_ERROR(ml::LabelSentences(ml::Conjunction::comma, folder / "tags.txt"), "[motionlang.config.102]");
  CHECK_ERROR(ml::LabelSentences(ml::Conjunction::during, folder / "nowhere.txt"), "[motionlang.io.401]");
}
