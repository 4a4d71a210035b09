// The tokenizers on the published vocabularies: 40 strings whose ids come from the
// original implementations, and all captions of KIT-ML. The data are not part of the repository: the test runs where
// the environment variable MOTIONLANG_DATA names a folder with tokenizers/ and text/kitml-annotations.json.
#include <doctest/doctest.h>

#include <cstdlib>
#include <filesystem>

#include <motionlang/datasets/annotations.hpp>
#include <motionlang/weights/tokenizer_files.hpp>

#include "../../support/tests_folder.hpp"

namespace ml = motionlang;
using ml::Index;
using Ids = std::vector<Index>;

namespace {

std::filesystem::path own_data(const char* name) {
  return std::filesystem::path(tests_folder()) / "unit/text/data" / name;
}

struct Published {
  std::filesystem::path folder = std::getenv("MOTIONLANG_DATA");
  ml::BertTokenizer bert = ml::read_bert_tokenizer(folder / "tokenizers/bert_vocab.txt");
  ml::BertTokenizer mpnet{ml::mpnet_vocabulary(bert.vocabulary()), ml::BertTokenizerOptions::mpnet()};
  ml::ClipTokenizer clip = ml::read_clip_tokenizer(folder / "tokenizers/bpe_simple_vocab_16e6.txt.gz");
  ml::ClipTokenizer clip_hf = ml::read_clip_tokenizer(folder / "tokenizers/bpe_simple_vocab_16e6.txt.gz",
                                                      {.cleaning = ml::ClipCleaning::hugging_face});
  nlohmann::json rows = ml::read_json(own_data("tokenizer_strings.json"));
};

/// Null, with a message, where there are no data.
const Published* published() {
  static const auto data = std::getenv("MOTIONLANG_DATA") ? std::make_unique<Published>() : nullptr;
  if (data == nullptr) MESSAGE("skipped: MOTIONLANG_DATA is not set");
  return data.get();
}

/// FNV-1a over the ids, as tests/tools/reference_tokenizers.py has it.
template <class F>
std::string digest(const std::vector<std::string>& texts, F encode) {
  std::uint64_t h = 0xCBF29CE484222325u;
  std::size_t count = 0;
  const auto add = [&](std::uint32_t id) {
    for (int byte = 0; byte < 4; ++byte) h = (h ^ (id >> 8 * byte & 255u)) * 0x100000001B3u;
  };
  for (const std::string& text : texts) {
    const Ids ids = encode(text);
    for (const Index id : ids) add(static_cast<std::uint32_t>(id));
    add(0xFFFFFFFFu);
    count += ids.size();
  }
  char text[80];
  std::snprintf(text, sizeof text, "%zu texts, %zu ids, %016llx", texts.size(), count,
                static_cast<unsigned long long>(h));
  return text;
}

}  // namespace

TEST_CASE("published tokenizers: 40 strings with ids of the original implementations") {
  const Published* p = published();
  if (p == nullptr) return;
  REQUIRE(p->bert.size() == 30522);
  REQUIRE(p->mpnet.size() == 30527);
  REQUIRE(p->clip.size() == 49408);
  REQUIRE(p->rows.size() == 40);
  for (const auto& row : p->rows) {
    const auto name = row["name"].get<std::string>(), text = row["text"].get<std::string>();
    CAPTURE(name);
    const auto want = row["bert"].get<Ids>();
    CHECK(p->bert.encode(text) == want);
    Ids mpnet;
    for (const Index id : want) mpnet.push_back(id == 101 ? 0 : id == 102 ? 2 : id + 4);
    if (row.contains("mpnet")) mpnet = row["mpnet"].get<Ids>();
    CHECK(p->mpnet.encode(text) == mpnet);
    if (name != "mojibake") CHECK(p->clip.encode_words(text) == row["clip"].get<Ids>());
  }
}

TEST_CASE("published tokenizers: single characters between letters") {
  const Published* p = published();
  if (p == nullptr) return;
  const auto ids = [&](std::initializer_list<const char*> pieces) {
    Ids out;
    for (const char* piece : pieces) out.push_back(p->bert.id(piece).value());
    return out;
  };
  const std::pair<std::string, Ids> rows[] = {
      {"a\u0378b", ids({"[UNK]"})},
      {"a\uE000b", ids({"ab"})},
      {"a\u061Cb", ids({"ab"})},
      {"a\u0085b", ids({"ab"})},
      {"a\vb", ids({"ab"})},
      {"a\u2029b", ids({"a", "b"})},
      {"a\U0002B820b", ids({"[UNK]"})},
      {"a\U0002B920b", ids({"a", "[UNK]", "b"})},
      {"\u212Aelvin", ids({"kelvin"})},
      {"\u2126", ids({"\u03C9"})},
      {"[CLS][SEP]", ids({"[CLS]", "[SEP]"})},
      {"a[MASK]b", ids({"a", "[MASK]", "b"})},
  };
  for (const auto& row : rows) {
    CAPTURE(row.first);
    const auto& [text, want] = row;
    CHECK(p->bert.encode_words(text) == want);
  }
}

TEST_CASE("published tokenizers: CLIP's context") {
  const Published* p = published();
  if (p == nullptr) return;
  const std::string text =
      "a person walks forward quickly, then turns around to the left and walks back to where they started, waving both "
      "arms";
  const Ids words{320, 2533, 8192, 2342, 7787, 267, 1594, 3185, 1630,  531,  518, 1823,
                  537, 8192, 893,  531,  1234, 889, 2760, 267,  26545, 2212, 5706};
  CHECK(p->clip.encode_words(text) == words);
  Ids humanml3d{49406};
  humanml3d.insert(humanml3d.end(), words.begin(), words.begin() + 20);
  humanml3d.push_back(49407);
  const auto mdm = ml::read_clip_tokenizer(p->folder / "tokenizers/bpe_simple_vocab_16e6.txt.gz", {.longest = 22});
  CHECK(mdm.encode(text) == humanml3d);
  humanml3d.resize(77, 0);
  CHECK(ml::tokenize(mdm, std::vector{text}).padded(mdm.pad_id(), 77) == humanml3d);

  std::string walks;
  for (int i = 0; i < 100; ++i) walks += "walk ";
  Ids full(77, 2374);
  full.front() = 49406, full.back() = 49407;
  CHECK(p->clip.encode(walks) == full);
  CHECK(p->clip.decode(p->clip.encode("A person walks, slowly.")) == "a person walks , slowly .");
}

// Digests of the ids that tests/tools/reference_tokenizers.py finds, a plain program in Python which shares no code or
// table with the library and reproduces the ids of the 40 strings. Captions are plain ASCII, so a second set has one
// of the 40 strings in the middle of each.
TEST_CASE("published tokenizers: 12,164 captions of KIT-ML") {
  const Published* p = published();
  if (p == nullptr) return;
  std::vector<std::string> captions, decorated;
  const auto file = ml::AnnotationFile::open(p->folder / "text/kitml-annotations.json");
  for (const std::string& id : file.ids()) {
    for (const ml::Annotation& a : file.load(id).annotations) captions.push_back(a.text);
  }
  for (std::size_t i = 0; i < captions.size(); ++i) {
    std::string text = captions[i];
    decorated.push_back(text.insert(7 * i % (text.size() + 1), p->rows[i % 40]["text"].get<std::string>()));
  }
  const auto bert = [&](const std::string& t) { return p->bert.encode(t); };
  const auto mpnet = [&](const std::string& t) { return p->mpnet.encode(t); };
  const auto clip = [&](const std::string& t) { return p->clip.encode_words(t); };
  const auto clip_hf = [&](const std::string& t) { return p->clip_hf.encode_words(t); };
  CHECK(digest(captions, bert) == "12164 texts, 140006 ids, 50f1747a7c05ce00");
  CHECK(digest(captions, mpnet) == "12164 texts, 140006 ids, 729facfbf944b831");
  CHECK(digest(captions, clip) == "12164 texts, 116335 ids, 2d4bfa7ed2d90302");
  CHECK(digest(captions, clip_hf) == "12164 texts, 116335 ids, 2d4bfa7ed2d90302");
  CHECK(digest(decorated, bert) == "12164 texts, 243541 ids, 2d12196b89566d3f");
  CHECK(digest(decorated, mpnet) == "12164 texts, 245669 ids, db7dd4abd5053f9b");
  CHECK(digest(decorated, clip) == "12164 texts, 248324 ids, 76ac03d000e008c2");
  CHECK(digest(decorated, clip_hf) == "12164 texts, 262826 ids, 81e10dacee1ecc0e");
}

TEST_CASE("published tokenizers: 50,000 mixtures of entities, marks, controls and words") {
  const Published* p = published();
  if (p == nullptr) return;
  const auto fragments = ml::read_json(own_data("tokenizer_fragments.json")).get<std::vector<std::string>>();
  std::uint32_t state = 1;
  const auto below = [&](std::size_t n) {
    state = state * 1664525u + 1013904223u;
    return (state >> 16) % n;
  };
  std::vector<std::string> mixed(50000);
  for (std::string& text : mixed) {
    for (std::size_t size = 1 + below(12); size > 0; --size) text += fragments[below(fragments.size())];
  }
  CHECK(digest(mixed, [&](const std::string& t) { return p->bert.encode(t); }) ==
        "50000 texts, 475137 ids, 7479e1c8831d241e");
  CHECK(digest(mixed, [&](const std::string& t) { return p->mpnet.encode(t); }) ==
        "50000 texts, 478938 ids, b01e54937f3dc874");
  CHECK(digest(mixed, [&](const std::string& t) { return p->clip.encode_words(t); }) ==
        "50000 texts, 522208 ids, bb6a813b4c929f92");
  CHECK(digest(mixed, [&](const std::string& t) { return p->clip_hf.encode_words(t); }) ==
        "50000 texts, 647995 ids, 77c15c94ae18f43f");
}
