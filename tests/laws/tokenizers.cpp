// The tokenizers that are published, our own, and the words of GloVe.
#include <motionlang/text/glove.hpp>
#include <motionlang/text/word_piece.hpp>
#include <motionlang/weights/tokenizer_json.hpp>

#include "../support/check_error.hpp"
#include "tokenizer_laws.hpp"

namespace ml = motionlang;
using ml::Index;

namespace {

const std::vector<std::string> bert_pieces{
    "[PAD]", "[UNK]", "[CLS]", "[SEP]", "a",  "person", "walk", "##s", "##ing", "sit",  "down",    "and", ".",
    ",",     "'",     "!",     "-",     "12", "cafe",   "x",    "##x", "s",     "jump", "forward", "b",   "\u8d70"};
const ml::BytePairMerges clip_merges{{"w", "a"},      {"wa", "l"}, {"wal", "k</w>"}, {"wal", "k"}, {"s", "i"},
                                     {"si", "t</w>"}, {"x", "x"},  {"xx", "xx"},     {"a", "n"}};

ml::BertTokenizer bert(Index longest = 512, bool truncate = false) {
  ml::BertTokenizerOptions options;
  options.longest = longest, options.truncate = truncate;
  return ml::BertTokenizer(bert_pieces, options);
}
ml::ClipTokenizer clip(ml::ClipCleaning cleaning, Index longest = 1000, bool truncate = true) {
  return ml::ClipTokenizer(clip_merges, {.cleaning = cleaning, .longest = longest, .truncate = truncate});
}
ml::WordPiece learnt() {
  return ml::WordPiece::learn(
      std::vector<std::string>{"walk forward", "raise both arms", "sit down", "walk and sit down"}, 40);
}

/// The numbers that TM2T takes: sos, the words, eos.
struct WordNumbers {
  ml::GloVe words;

  std::vector<Index> encode(std::string_view text, Index longest = 22) const {
    std::vector<Index> ids;
    for (const ml::TaggedWord& w : ml::GloVe::framed(words.tokens(text), longest - 2)) ids.push_back(words.id(w.word));
    return ids;
  }
  Index size() const { return words.size(); }
};
WordNumbers word_numbers() {
  const std::vector<std::string> words{"sos", "eos", "unk", "walk", "forward", "sit", "down", "person", "jump"};
  return {ml::GloVe(words, std::vector<float>(words.size()), 1)};
}

}  // namespace

TEST_CASE("laws of tokenizers") {
  laws::tokenizer_laws(learnt());
  laws::tokenizer_laws(bert());
  laws::tokenizer_laws(bert(8, true));
  laws::tokenizer_laws(clip(ml::ClipCleaning::original));
  laws::tokenizer_laws(clip(ml::ClipCleaning::hugging_face));
  laws::tokenizer_laws(clip(ml::ClipCleaning::original, 6));
  laws::tokenizer_laws(ml::AnyTokenizer(bert()));
  laws::tokenizer_laws(ml::AnyTokenizer(clip(ml::ClipCleaning::hugging_face)));
  laws::tokenizer_laws(word_numbers());
}

TEST_CASE("tokenizers cut a text to the length that is wanted, or refuse it") {
  const std::string_view text = "walk forward and sit down, walk forward";
  laws::length_law(text, 2, [](std::string_view t, Index longest) { return learnt().encode(t, longest); });
  laws::length_law(text, 2, [](std::string_view t, Index longest) { return word_numbers().encode(t, longest); });
  laws::length_law(text, 3, [](std::string_view t, Index longest) { return bert(longest, true).encode(t); });
  for (const auto cleaning : {ml::ClipCleaning::original, ml::ClipCleaning::hugging_face})
    laws::length_law(text, 4, [&](std::string_view t, Index longest) { return clip(cleaning, longest).encode(t); });

  const Index whole = std::ssize(bert().encode(text)),
              pieces = std::ssize(clip(ml::ClipCleaning::original).encode(text));
  CHECK(bert(whole).encode(text) == bert().encode(text));
  CHECK_ERROR(bert(whole - 1).encode(text), "[motionlang.config.101] BertTokenizer: a text of ");
  CHECK_ERROR(clip(ml::ClipCleaning::original, pieces - 1, false).encode(text),
              "[motionlang.config.101] ClipTokenizer: a text of ");
}

TEST_CASE("tokenizers that decode give back what was encoded") {
  laws::decoding_law(bert(), "a person walks and sit - down .");
  laws::decoding_law(ml::AnyTokenizer(bert()), "a person walking , \u8d70 !");
  for (const auto cleaning : {ml::ClipCleaning::original, ml::ClipCleaning::hugging_face}) {
    laws::decoding_law(clip(cleaning), "a person walks 1 2 'll caf\u00e9 \u8d70\u8def !?");
    laws::decoding_law(ml::AnyTokenizer(clip(cleaning)), "sit \U0001F3C3");
  }
  const ml::GloVe words = word_numbers().words;
  for (Index id = 0; id < words.size(); ++id) CHECK(words.id(words.word(id)) == id);
}
