// The word-piece tokenizer: learning, encoding, texts that hurt.
#include <motionlang/text/tokenizer.hpp>
#include <motionlang/text/word_piece.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using ml::Index, ml::WordPiece;
using Ids = std::vector<Index>;
using Words = std::vector<std::string>;

static_assert(ml::Tokenizer<WordPiece>);

namespace {

const Words captions{"a person walks forward", "a person is walking", "the person walked and waved", "walk, wave!"};

/// The words that ids spell.
Words spelled(const WordPiece& pieces, const Ids& ids) {
  Words out;
  for (Index id : ids) {
    const std::string& piece = pieces.vocabulary()[static_cast<std::size_t>(id)];
    if (piece.starts_with("##"))
      out.back() += piece.substr(2);
    else
      out.push_back(piece);
  }
  return out;
}

}  // namespace

TEST_CASE("words: lower case, letters and digits, everything else separates") {
  CHECK(WordPiece::words("Walk, 2 steps\tTHEN wave!") == Words{"walk", "2", "steps", "then", "wave"});
  CHECK(WordPiece::words("").empty());
  CHECK(WordPiece::words(" .,!\n").empty());
  CHECK(WordPiece::words("caf\xC3\xA9 na\xC3\xAFve") == Words{"caf", "na", "ve"});  // letters beyond ASCII separate
}

TEST_CASE("learning: reserved pieces, letters, then merges, deterministic") {
  const auto learnt = WordPiece::learn(captions, 60);
  CHECK(learnt.size() <= 60);
  CHECK(learnt.vocabulary()[WordPiece::begin_id] == "[CLS]");
  CHECK(learnt.vocabulary()[WordPiece::end_id] == "[SEP]");
  CHECK(learnt.vocabulary()[WordPiece::unknown_id] == "[UNK]");
  CHECK(WordPiece::learn(captions, 60).vocabulary() == learnt.vocabulary());
  const auto letters = WordPiece::learn(captions, 0);  // a size below the letters gives the letters
  CHECK(learnt.size() > letters.size());
  for (std::size_t i = 3; i < letters.vocabulary().size(); ++i)
    CHECK(letters.vocabulary()[i].size() == (letters.vocabulary()[i].starts_with("##") ? 3u : 1u));
  const Words none;
  CHECK(WordPiece::learn(none, 100).size() == 3);
}

TEST_CASE("what was learnt is spelled again, whole words or pieces") {
  const auto pieces = WordPiece::learn(captions, 60);
  for (const std::string& text : captions) {
    Words expected = WordPiece::words(text);
    expected.insert(expected.begin(), "[CLS]");
    expected.push_back("[SEP]");
    CHECK(spelled(pieces, pieces.encode(text)) == expected);
  }
  CHECK(spelled(pieces, pieces.encode("wander")) == Words{"[CLS]", "wander", "[SEP]"});  // new word, known letters
  CHECK(pieces.encode("PERSON") == pieces.encode("person"));
}

TEST_CASE("the longest piece is taken first") {
  const WordPiece pieces({"[CLS]", "[SEP]", "[UNK]", "w", "walk", "##a", "##l", "##k", "##ing", "##i", "##n"});
  CHECK(pieces.encode("walking") == Ids{0, 4, 8, 1});
  CHECK(pieces.encode("walk") == Ids{0, 4, 1});
  CHECK(pieces.encode("wal") == Ids{0, 3, 5, 6, 1});
  CHECK(pieces.encode("walks") == Ids{0, 2, 1});  // one unknown letter makes the word unknown
  CHECK(pieces.encode("walks walk") == Ids{0, 2, 4, 1});
}

TEST_CASE("texts without words, unknown words, long texts") {
  const auto pieces = WordPiece::learn(captions, 60);
  CHECK(pieces.encode("") == Ids{0, 1});
  CHECK(pieces.encode("?!") == Ids{0, 1});
  CHECK(pieces.encode("\xE6\xAD\xA9\xE3\x81\x8F \xF0\x9F\x9A\xB6") == Ids{0, 1});
  CHECK(pieces.encode("xyz") == Ids{0, 2, 1});
  const auto cut = pieces.encode("walk walk walk walk walk", 4);
  CHECK(cut.size() == 4);
  CHECK(cut.back() == WordPiece::end_id);
  CHECK(WordPiece().encode("walk") == Ids{0, 2, 1});
}

TEST_CASE("vocabularies that cannot be are refused") {
  CHECK_ERROR(WordPiece(Words{}), "[motionlang.config.107] WordPiece");
  CHECK_ERROR(WordPiece({"[SEP]", "[CLS]", "[UNK]"}), "[motionlang.config.107]");
  CHECK_ERROR(WordPiece({"[CLS]", "[SEP]", "[UNK]", "a", "b", "a"}), "piece 'a' is duplicated");
}
