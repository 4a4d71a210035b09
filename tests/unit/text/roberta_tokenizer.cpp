// The tokenizer of RoBERTa: words with the blank before them, white space, merges, frames.
#include <motionlang/text/roberta_tokenizer.hpp>

#include <doctest/doctest.h>

#include <motionlang/text/detail/byte_symbols.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using ml::Index;
using Pieces = std::vector<std::string>;

namespace {

using Merges = ml::RobertaTokenizer::Merges;

const Merges merges{{"w", "a"}, {"l", "k"}, {"wa", "lk"}, {"Ġ", "walk"}, {"Ġ", "a"}, {"1", "2"}};

Pieces vocabulary() {
  Pieces out{"<s>", "<pad>", "</s>", "<unk>"};
  for (const unsigned char b : ml::detail::ByteSymbols::get().in_order)
    out.push_back(ml::detail::ByteSymbols::get().symbol[b]);
  for (const auto& [left, right] : merges) out.push_back(left + right);
  out.push_back("<mask>");
  return out;
}
Pieces pieces_of(const ml::RobertaTokenizer& tokenizer, std::span<const Index> ids) {
  Pieces out;
  for (const Index id : ids) out.push_back(tokenizer.vocabulary()[static_cast<std::size_t>(id)]);
  return out;
}

}  // namespace

TEST_CASE("words keep the blank before them, and merges come in their order") {
  const ml::RobertaTokenizer tokenizer(vocabulary(), merges);
  const auto pieces = [&](std::string_view text) { return pieces_of(tokenizer, tokenizer.encode_words(text)); };
  CHECK(pieces("a walk") == Pieces{"a", "Ġwalk"});
  CHECK(pieces(" a walk") == Pieces{"Ġa", "Ġwalk"});
  CHECK(pieces("walks") == Pieces{"walk", "s"});
  CHECK(pieces("Walk") == Pieces{"W", "a", "lk"});  // case matters
  CHECK(pieces("walk's") == Pieces{"walk", "'", "s"});
  CHECK(pieces("walk 's") == Pieces{"walk", "Ġ", "'", "s"});
  CHECK(pieces("a12 12") == Pieces{"a", "12", "Ġ", "12"});
  CHECK(pieces("walk, a!") == Pieces{"walk", ",", "Ġa", "!"});
  // of several white characters the last one goes with the word, if it is a blank
  CHECK(pieces("a  walk") == Pieces{"a", "Ġ", "Ġwalk"});
  CHECK(pieces("a \nwalk") == Pieces{"a", "Ġ", "Ċ", "walk"});
  CHECK(pieces("a\nwalk") == Pieces{"a", "Ċ", "walk"});
  CHECK(pieces("a  ") == Pieces{"a", "Ġ", "Ġ"});
  CHECK(pieces("").empty());
  CHECK(pieces("é") == Pieces{"Ã", "©"});
  CHECK(pieces("\xFF") == pieces("\xEF\xBF\xBD"));  // not UTF-8
  for (int again = 0; again < 2; ++again) CHECK(pieces("walk walk") == Pieces{"walk", "Ġwalk"});
}

TEST_CASE("frames, pairs, special tokens, and texts that are too long") {
  const ml::RobertaTokenizer tokenizer(vocabulary(), merges, {.longest = 6});
  CHECK(pieces_of(tokenizer, tokenizer.encode("a walk")) == Pieces{"<s>", "a", "Ġwalk", "</s>"});
  CHECK(pieces_of(tokenizer, tokenizer.encode("a<mask>a")) == Pieces{"<s>", "a", "<mask>", "a", "</s>"});
  const auto pair = tokenizer.encode_pair("a", "a");
  CHECK(pieces_of(tokenizer, pair.ids) == Pieces{"<s>", "a", "</s>", "</s>", "a", "</s>"});
  CHECK(pair.types == std::vector<Index>(6, 0));
  CHECK(tokenizer.pad_id() == 1);
  CHECK(tokenizer.size() == 4 + 256 + 6 + 1);
  CHECK_ERROR(tokenizer.encode("a a a a a"), "[motionlang.config.101]");
  const ml::RobertaTokenizer cut(vocabulary(), merges, {.longest = 6, .truncate = true});
  CHECK(pieces_of(cut, cut.encode("a a a a a")) == Pieces{"<s>", "a", "Ġa", "Ġa", "Ġa", "</s>"});
  const ml::RobertaTokenizer whole(vocabulary(), merges);
  CHECK(whole.decode(whole.encode("a walké ")) == "a walké ");
  const std::vector<Index> beyond{tokenizer.size()};
  CHECK_ERROR(tokenizer.decode(beyond), "[motionlang.shape.203]");
}

TEST_CASE("a vocabulary without marks, with a piece twice, or with a merge of unknown pieces is refused") {
  auto pieces = vocabulary();
  CHECK_ERROR(ml::RobertaTokenizer(pieces, {{"x", "yz"}}), "[motionlang.config.107]");
  pieces[1] = "pad";
  CHECK_ERROR(ml::RobertaTokenizer(pieces, merges, {}, "vocab.json"), "vocab.json: 267 pieces lack '<pad>'");
  pieces[1] = "<pad>", pieces.push_back("walk");
  CHECK_ERROR(ml::RobertaTokenizer(pieces, merges), "duplicated");
  CHECK_ERROR(ml::RobertaTokenizer(vocabulary(), merges, {.longest = 3}), "[motionlang.config.101]");
}
