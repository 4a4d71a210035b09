// BERT's and MPNet's tokenizer on a small vocabulary: ids, frames, added tokens, limits, decoding.
#include <motionlang/text/bert_tokenizer.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using ml::BertTokenizer, ml::BertTokenizerOptions, ml::Index;
using Ids = std::vector<Index>;
using Words = std::vector<std::string>;

namespace {

const Words pieces{"[PAD]", "[UNK]", "[CLS]",  "[SEP]",  "[MASK]",   "a",       "person", "walk", "##s",
                   "##ing", "##er",  "un",     "##aff",  "##able",   ".",       ",",      "'",    "-",
                   "!",     "jump",  "run",    "##n",    "10",       "1",       "##0",    "cafe", "s",
                   "t",     "don",   "\u8d70", "\u1102", "##\u1161", "##\u116b"};

}  // namespace

TEST_CASE("BertTokenizer: ids of the original implementation") {
  const BertTokenizer bert(pieces);
  const std::pair<std::string, Ids> rows[] = {
      {"a person walks.", {2, 5, 6, 7, 8, 14, 3}},
      {"UNAFFABLE walking, walker!", {2, 11, 12, 13, 7, 9, 15, 7, 10, 18, 3}},
      {"don't jump-run", {2, 28, 16, 27, 19, 17, 20, 3}},
      {"Caf\u00e9 cafe\u0301", {2, 25, 25, 3}},
      {"a\u8d70b", {2, 5, 29, 1, 3}},
      {"101 10 1", {2, 1, 22, 23, 3}},
      {"[MASK] walk", {2, 4, 7, 3}},
      {"walk\u200Bs run\u0007n", {2, 7, 8, 20, 21, 3}},
      {"", {2, 3}},
      {"runn\u00e9r", {2, 20, 21, 10, 3}},
      {"\ub098", {2, 30, 31, 3}},  // a syllable of Hangul, taken apart
      {"[mask]", {2, 1, 1, 1, 3}},
      {"walk[SEP]", {2, 7, 3, 3}},
  };
  for (const auto& row : rows) {
    CAPTURE(row.first);
    const auto& [text, ids] = row;
    CHECK(bert.encode(text) == ids);
  }
  CHECK(bert.encode("a \xFF\xFE walk") == bert.encode("a walk"));  // not UTF-8: U+FFFD, which is dropped
}

TEST_CASE("BertTokenizer: words of more than 100 code points are unknown") {
  BertTokenizerOptions options;
  const BertTokenizer bert({"[UNK]", "[CLS]", "[SEP]", "x", "##x"}, options);
  CHECK(bert.encode_words(std::string(100, 'x')).size() == 100);
  CHECK(bert.encode_words(std::string(101, 'x')) == Ids{0});
  options.longest_word = 3;
  CHECK(BertTokenizer({"[UNK]", "[CLS]", "[SEP]", "x", "##x"}, options).encode_words("xxx xxxx") == Ids{3, 4, 4, 0});
}

TEST_CASE("BertTokenizer: options of the normaliser") {
  BertTokenizerOptions cased;
  cased.lower_case = false;
  CHECK(BertTokenizer(pieces, cased).normalized("Caf\u00c9") == "Caf\u00c9");
  cased.strip_accents = true;
  CHECK(BertTokenizer(pieces, cased).normalized("Caf\u00c9") == "CafE");
  BertTokenizerOptions accents;
  accents.strip_accents = false;
  CHECK(BertTokenizer(pieces, accents).normalized("Caf\u00c9 \u0130") == "caf\u00e9 i\u0307");
  BertTokenizerOptions raw;
  raw.clean_text = raw.split_cjk = raw.lower_case = false;
  CHECK(BertTokenizer(pieces, raw).normalized("a\u0007\tB\u8d70") == "a\u0007\tB\u8d70");
  CHECK(BertTokenizer(pieces, raw).normalized("a\u0007\tB") == "a\u0007\tB");
}

TEST_CASE("BertTokenizer: pairs") {
  const BertTokenizer bert(pieces);
  const auto [ids, types] = bert.encode_pair("a person", "walks");
  CHECK(ids == Ids{2, 5, 6, 3, 7, 8, 3});
  CHECK(types == Ids{0, 0, 0, 0, 1, 1, 1});

  const BertTokenizer mpnet(ml::mpnet_vocabulary(pieces), BertTokenizerOptions::mpnet());
  const auto pair = mpnet.encode_pair("a person", "walks");
  CHECK(pair.ids == Ids{0, 9, 10, 2, 2, 11, 12, 2});
  CHECK(pair.types == Ids(8, 0));
}

TEST_CASE("MPNet: other marks around the same words") {
  const BertTokenizer mpnet(ml::mpnet_vocabulary(pieces), BertTokenizerOptions::mpnet());
  CHECK(mpnet.size() == 38);
  CHECK(mpnet.pad_id() == 1);
  CHECK(mpnet.encode("a person xyz") == Ids{0, 9, 10, 5, 2});
  CHECK(mpnet.encode("walk <mask></s>[UNK]") == Ids{0, 11, 37, 2, 5, 2});
  CHECK(mpnet.encode("[MASK]") == Ids{0, 5, 5, 5, 2});  // plain text here
}

TEST_CASE("BertTokenizer: too long a text is refused, or cut behind its first words") {
  BertTokenizerOptions options;
  options.longest = 4;
  const BertTokenizer strict(pieces, options);
  CHECK(strict.encode("a person") == Ids{2, 5, 6, 3});
  CHECK_ERROR(strict.encode("a person walks"), "[motionlang.config.101] BertTokenizer: a text of 6 ids, at most 4");
  options.truncate = true;
  CHECK(BertTokenizer(pieces, options).encode("a person walks") == Ids{2, 5, 6, 3});
  CHECK_ERROR(BertTokenizer(pieces, options).encode_pair("a", "person"), "5 ids, at most 4");
  options.longest = 2;
  CHECK_ERROR(BertTokenizer(pieces, options), "[motionlang.config.101]");
}

TEST_CASE("BertTokenizer: added tokens before and after normalisation") {
  const BertTokenizer bert(pieces, {}, "test", {{{"Walk", 4, false}, {"RUN", 1, true}, {"WalkWalk", 3, false}}});
  CHECK(bert.encode_words("walk Walk run WalkWalk [CLS]") == Ids{7, 4, 1, 3, 1, 1, 1});
  CHECK_ERROR(BertTokenizer(pieces, {}, "test", {{{"x", 33}}}), "[motionlang.config.107] test: id 33 among 33 pieces");
}

TEST_CASE("BertTokenizer: decoding") {
  const BertTokenizer bert(pieces);
  CHECK(bert.decode(bert.encode("a person walks, jump!")) == "a person walks , jump !");
  CHECK(bert.decode(Ids{8}) == "##s");  // continues nothing
  CHECK(bert.decode({}).empty());
  CHECK_ERROR(bert.decode(Ids{33}), "[motionlang.shape.203]");
  CHECK_ERROR(bert.decode(Ids{-1}), "[motionlang.shape.203]");
}

TEST_CASE("BertTokenizer: vocabularies that cannot work") {
  CHECK_ERROR(BertTokenizer({"[UNK]", "[CLS]", "[SEP]", "a", "a"}), "piece 'a' is duplicated, the second time as id 4");
  CHECK_ERROR(BertTokenizer({"[UNK]", "[CLS]", "a"}),
              "[motionlang.config.107] BertTokenizer: a vocabulary of 3 pieces lacks '[SEP]'");
  CHECK_ERROR(BertTokenizer({"[UNK]", "[CLS]", "[SEP]", ""}), "piece 3 is empty");
  CHECK_ERROR(BertTokenizer({"[UNK]", "[CLS]", "[SEP]", "\xFF"}), "piece 3 is not UTF-8");
  CHECK_ERROR(BertTokenizer({"[UNK]", "[CLS]", "[SEP]"}).pad_id(), "[motionlang.config.103]");
}

TEST_CASE("tokenize: ids one after the other, and filled up") {
  const Words texts{"a", "", "a person walks"};
  const auto batch = ml::tokenize(BertTokenizer(pieces), texts);
  CHECK(batch.ids == Ids{2, 5, 3, 2, 3, 2, 5, 6, 7, 8, 3});
  CHECK(batch.lengths == Ids{3, 2, 6});
  CHECK(batch.padded(0) == Ids{2, 5, 3, 0, 0, 0, 2, 3, 0, 0, 0, 0, 2, 5, 6, 7, 8, 3});
  CHECK(batch.padded(9, 7).size() == 21);
  CHECK_ERROR(batch.padded(0, 5), "[motionlang.shape.204]");
  CHECK(ml::TokenBatch{}.padded(0).empty());
}

TEST_CASE("a copy of a tokenizer outlives it") {
  auto first = std::make_unique<BertTokenizer>(pieces);
  const BertTokenizer second = *first;
  first.reset();
  CHECK(second.encode("a person") == Ids{2, 5, 6, 3});
}

TEST_CASE("frames that do not fit leave the tokenizer as it was") {
  ml::BertTokenizerOptions options;
  options.longest = 4;
  ml::BertTokenizer bert({"[UNK]", "[CLS]", "[SEP]", "a"}, options);
  const auto before = bert.encode("a");
  const std::vector<ml::FramePart> long_frame(5, {ml::FramePart::token, 1});
  CHECK_THROWS_AS(bert.set_frames(long_frame, long_frame, "x"), ml::config_error);
  CHECK(bert.encode("a") == before);
}
