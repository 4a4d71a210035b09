// Word vectors with parts of speech: look-up, tags, frames, captions, files.
#include <doctest/doctest.h>

#include <numeric>

#include <motionlang/backend/reference.hpp>
#include <motionlang/weights/glove_file.hpp>

#include "../../support/check_error.hpp"
#include "../../support/glove_files.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using B = ml::ReferenceBackend<double>;
using ml::Index;

namespace {

const std::vector<std::string> words{"sos", "eos", "unk", "a", "man", "walk", "left", "dance", "blue"};

std::vector<float> numbers() {
  std::vector<float> out;
  for (int i = 0; i < 18; ++i) out.push_back(static_cast<float>(i));
  return out;
}
static_assert(ml::TextEncoder<ml::GloVe, B>);
ml::GloVe small() { return ml::GloVe(words, numbers(), 2); }

}  // namespace

TEST_CASE("words and tags") {
  const auto g = small();
  CHECK(g.vector("man")[0] == 8);
  CHECK(g.vector("unheard")[1] == 5);  // of unk
  using enum ml::SpeechTag;
  CHECK(g.tag({"man", "NOUN"}) == noun);
  CHECK(g.tag({"walk", "NOUN"}) == act);  // the lists come first
  CHECK(g.tag({"left", "VERB"}) == loc);
  CHECK(g.tag({"blue", "COLOUR"}) == other);
  CHECK(g.tag({"arm", "NOUN"}) == other);  // not in the vocabulary
  CHECK(g.tag({"sos", "OTHER"}) == other);
  CHECK(ml::motion_tag("feet") == body);
  CHECK(ml::motion_tag("raise") == act);
  CHECK_FALSE(ml::motion_tag("and").has_value());  // only whole words
  CHECK(ml::speech_tag("Desc_VIP") == desc);
}

TEST_CASE("numbers of words, and words of numbers") {
  const auto g = small();
  CHECK(g.id("man") == 4);
  CHECK(g.id("unheard") == 2);
  CHECK(g.word(4) == "man");
  CHECK(g.word(9) == "pad");
  CHECK_ERROR(g.word(10), "[motionlang.shape.203]");
  CHECK_ERROR(g.word(-1), "[motionlang.shape.203]");
}

TEST_CASE("rows of a text: sos, words, eos; at most twenty words") {
  const auto g = small();
  const std::vector<std::string> texts{"a/DET man/NOUN walk/VERB", ""};
  const auto t = g.encode<B>(texts);
  CHECK(t.tokens.offsets == ml::Offsets{5, 2});
  CHECK(t.tokens.width() == 17);
  const auto row = t.tokens.rows.to_vector();
  CHECK(row[2 * 17] == 8);
  CHECK(row[2 * 17 + 2 + 1] == 1);   // NOUN
  CHECK(row[3 * 17 + 2 + 12] == 1);  // Act_VIP
  CHECK(std::accumulate(row.begin() + 17 + 2, row.begin() + 2 * 17, 0.0) == 1);
  std::string many;
  for (int i = 0; i < 30; ++i) many += " a/DET";
  CHECK(g.encode<B>(std::vector<std::string>{many}).tokens.rows.size(0) == 22);
  CHECK_ERROR(g.tokens("a/DET man"), "[motionlang.config.107]");
  CHECK_ERROR(g.tokens("a/DET b/c/d"), "[motionlang.config.107]");
}

TEST_CASE("captions without tags: known forms of words") {
  const auto g = small();
  const auto forms = [&](const char* caption) {
    std::vector<std::string> out;
    for (const auto& w : g.tokens(caption)) out.push_back(w.word);
    return out;
  };
  using Words = std::vector<std::string>;
  CHECK(forms("A man walks, dancing and DANCED; walked zigzags") ==
        Words{"a", "man", "walk", "dance", "and", "dance", "walk", "zigzags"});
  CHECK(forms("walks anti-clockwise") == Words{"walk", "anticlockwise"});
  CHECK(forms("A man walks and/or dances.") == Words{"a", "man", "walk", "and", "or", "dance"});
  CHECK(forms("walks 3 steps on the 2nd line") == Words{"walk", "steps", "on", "the", "line"});
}

TEST_CASE("the three files") {
  const TemporaryFolder folder;
  const std::string stem = (folder / "our_vab").string();
  const auto write = [&](const std::vector<std::string>& list, const std::vector<std::string>& places) {
    auto vectors = numbers();
    vectors.resize(2 * 9);
    glove_files::write(stem, list, places, vectors);
    return ml::read_glove(stem);
  };
  CHECK(write(words, words).vector("left")[0] == 12);
  std::vector<std::string> many{"sos", "eos", "unk", std::string(300, 'a')};  // more than one byte for lengths and rows
  while (many.size() < 400) many.push_back("word" + std::to_string(many.size()));
  std::vector<float> rows(2 * many.size());
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = static_cast<float>(i);
  const ml::GloVe large(many, rows, 2);
  CHECK(large.words() == many);
  ml::write_glove(stem, large);
  const auto again = ml::read_glove(stem);
  CHECK(again.words() == many);
  CHECK(again.vector("word399")[1] == 799);
  auto other = words;
  other[4] = "woman";
  CHECK_ERROR(write(other, words), "[motionlang.io.403]");
  other.pop_back();
  CHECK_ERROR(write(words, other), "[motionlang.io.403]");
}

TEST_CASE("vocabularies that cannot be are refused") {
  CHECK_ERROR(ml::GloVe(words, numbers(), 3), "[motionlang.shape.205]");
  auto twice = words;
  twice[5] = "man";
  CHECK_ERROR(ml::GloVe(twice, numbers(), 2), "[motionlang.config.103]");
  auto without = words;
  without[2] = "unknown";
  CHECK_ERROR(ml::GloVe(without, numbers(), 2), "[motionlang.config.103]");
}
