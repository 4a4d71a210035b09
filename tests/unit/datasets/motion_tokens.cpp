// Motion tokens in files, entries of parts of clips, marks around tokens and words.
#include <motionlang/core/numpy_random.hpp>
#include <motionlang/datasets/motion_tokens.hpp>
#include <motionlang/text/glove.hpp>
#include <motionlang/vae/motion_tokenizer.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using ml::Index, ml::TokenLines;

TEST_CASE("token lines: there and back, and what is refused with its line") {
  const TokenLines lines{{3, 0, 1023}, {5}};
  CHECK(ml::format_token_lines(lines) == "3 0 1023\n5\n");
  CHECK(ml::parse_token_lines(ml::format_token_lines(lines)) == lines);
  CHECK(ml::parse_token_lines(" 1  2 \r\n\n3") == TokenLines{{1, 2}, {3}});
  for (const char* bad : {"1 x", "1 -2", "1024", "1.5", "99999999999999999999"})
    CHECK_ERROR(ml::parse_token_lines(bad), "[motionlang.io.403] tokens:1");
  CHECK_ERROR(ml::parse_token_lines("1\n7", 7), "tokens:2: '7'");
}

TEST_CASE("entries: parts by their seconds, the whole clip with all of its tokens, unless as published") {
  const auto captions = ml::parse_captions(
      "all#all/NOUN#0.0#0.0\nlate#late/ADV#1.0#9.0\nearly#early/ADV#0.0#0.4\nnothing#nothing/NOUN#5.0#6.0\n"
      "instant#instant/NOUN#0.2#0.3\n");
  const TokenLines lines{{0, 1, 2, 3, 4, 5, 6, 7}};
  const auto entries = ml::token_entries("c", captions, lines);
  REQUIRE(entries.size() == 3);
  CHECK(entries[0].name == "c_1.000000_9.000000");
  CHECK(entries[0].lines == TokenLines{{5, 6, 7}});
  CHECK(entries[1].lines == TokenLines{{0, 1}});
  CHECK(entries[2].name == "c");
  CHECK(entries[2].lines == lines);
  CHECK(entries[2].captions.size() == 1);
  const auto published = ml::token_entries("c", captions, lines, {.cut_again = true});
  REQUIRE(published.size() == 4);  // the part of no length alone is left out
  CHECK(published[1].lines == TokenLines{{5, 6}});
  CHECK(published[2].name == "c_5.000000_6.000000");
  CHECK(published[2].lines == TokenLines{{}});
  CHECK(published[3].lines == TokenLines{{}});
  CHECK(ml::token_entries("c", captions, {}, {.cut_again = true}).size() == 1);      // no line of tokens at all
  CHECK(ml::token_entries("c", std::span(captions).subspan(1), lines).size() == 2);  // no caption of the whole clip
}

TEST_CASE("marks around tokens and words; one item in three loses a token") {
  const ml::MotionVocabulary v{10};
  const std::vector<Index> tokens{4, 5, 6};
  CHECK(ml::marked_tokens(tokens, v) == std::vector<Index>{10, 4, 5, 6, 11});
  CHECK(ml::marked_tokens(tokens, v, ml::TokenDrop::first) == std::vector<Index>{10, 5, 6, 11});
  CHECK(ml::marked_tokens(tokens, v, ml::TokenDrop::last) == std::vector<Index>{10, 4, 5, 11});
  CHECK_ERROR(ml::marked_tokens({}, v, ml::TokenDrop::last), "[motionlang.shape.207]");
  const ml::GloVe glove({"sos", "eos", "unk", "walk"}, {0, 1, 2, 3}, 1);
  const std::vector<ml::TaggedWord> words{{"walk", "VERB"}, {"zebra", "NOUN"}};
  CHECK(ml::marked_words(glove, words) == std::vector<Index>{0, 3, 2, 1});
  CHECK(ml::marked_words(glove, words, 1) == std::vector<Index>{0, 3, 1});
  ml::NumpyRandom random(3);
  std::array<int, 3> count{};
  for (int i = 0; i < 3000; ++i) ++count[static_cast<std::size_t>(ml::token_drop(random))];
  CHECK(std::abs(count[0] - 2000) < 120);
  CHECK(std::abs(count[1] - 500) < 90);
  CHECK(std::abs(count[2] - 500) < 90);
}
