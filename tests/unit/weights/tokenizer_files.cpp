// Files of tokenizers: vocab.txt, merges.txt, gzip, tokenizer.json, tokenizer_config.json, vocab.json, and folders of
// them.
#include <motionlang/file/file.hpp>
#include <motionlang/file/gzip.hpp>
#include <motionlang/file/json.hpp>
#include <motionlang/weights/tokenizer_json.hpp>

#include "../../support/check_error.hpp"
#include "../../support/roberta_json.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
using ml::Index;
using Ids = std::vector<Index>;
using Words = std::vector<std::string>;

namespace {

const std::string bert_json = R"({
  "truncation": {"max_length": 4, "strategy": "LongestFirst", "stride": 0}, "padding": null,
  "added_tokens": [
    {"id": 0, "content": "[UNK]", "special": true, "normalized": false, "lstrip": false, "rstrip": false, "single_word": false},
    {"id": 6, "content": "<mask>", "special": true, "normalized": false, "lstrip": true, "rstrip": false, "single_word": false}],
  "normalizer": {"type": "BertNormalizer", "clean_text": true, "handle_chinese_chars": true, "strip_accents": null, "lowercase": true},
  "pre_tokenizer": {"type": "BertPreTokenizer"},
  "post_processor": {"type": "TemplateProcessing",
    "single": [{"SpecialToken": {"id": "[CLS]", "type_id": 0}}, {"Sequence": {"id": "A", "type_id": 0}},
               {"SpecialToken": {"id": "[SEP]", "type_id": 0}}],
    "pair": [{"SpecialToken": {"id": "[CLS]", "type_id": 0}}, {"Sequence": {"id": "A", "type_id": 0}},
             {"SpecialToken": {"id": "[SEP]", "type_id": 0}}, {"Sequence": {"id": "B", "type_id": 1}},
             {"SpecialToken": {"id": "[SEP]", "type_id": 1}}],
    "special_tokens": {"[CLS]": {"id": "[CLS]", "ids": [1], "tokens": ["[CLS]"]},
                       "[SEP]": {"id": "[SEP]", "ids": [2], "tokens": ["[SEP]"]}}},
  "decoder": {"type": "WordPiece", "prefix": "##", "cleanup": true},
  "model": {"type": "WordPiece", "unk_token": "[UNK]", "continuing_subword_prefix": "##", "max_input_chars_per_word": 6,
            "vocab": {"[UNK]": 0, "[CLS]": 1, "[SEP]": 2, "walk": 3, "##s": 4, "a": 5}}})";

const std::string clip_json = R"({
  "added_tokens": [{"id": 11, "content": "<|startoftext|>", "special": true, "normalized": true},
                   {"id": 12, "content": "<|endoftext|>", "special": true, "normalized": false}],
  "normalizer": {"type": "Sequence", "normalizers": [{"type": "NFC"},
    {"type": "Replace", "pattern": {"Regex": "\\s+"}, "content": " "}, {"type": "Lowercase"}]},
  "pre_tokenizer": {"type": "Sequence", "pretokenizers": [
    {"type": "Split", "pattern": {"Regex": "'s|'t|'re|'ve|'m|'ll|'d|[\\p{L}]+|[\\p{N}]|[^\\s\\p{L}\\p{N}]+"},
     "behavior": "Removed", "invert": true},
    {"type": "ByteLevel", "add_prefix_space": false, "trim_offsets": true}]},
  "post_processor": {"type": "RobertaProcessing", "sep": ["<|endoftext|>", 12], "cls": ["<|startoftext|>", 11],
                     "trim_offsets": false, "add_prefix_space": false},
  "model": {"type": "BPE", "dropout": null, "unk_token": "<|endoftext|>", "continuing_subword_prefix": "",
            "end_of_word_suffix": "</w>", "fuse_unk": false,
            "vocab": {"a": 0, "k": 1, "l": 2, "s": 3, "w": 4, "a</w>": 5, "k</w>": 6, "s</w>": 7, "wa": 8, "wal": 9,
                      "walk</w>": 10, "<|startoftext|>": 11, "<|endoftext|>": 12},
            "merges": ["w a", ["wa", "l"], "wal k</w>"]}})";

ml::AnyTokenizer from_json(const std::string& text, const ml::TokenizerLimits& limits = {}) {
  const auto document = ml::parse_json(text);
  return ml::tokenizer_from_json(ml::JsonView(document, "tokenizer.json"), limits);
}

/// The text with one part of it replaced. The part has to be there.
std::string with(std::string text, std::string_view part, std::string_view other) {
  const std::size_t at = text.find(part);
  REQUIRE(at != text.npos);
  return text.replace(at, part.size(), other);
}

}  // namespace

TEST_CASE("vocab.txt: one piece a line") {
  CHECK(ml::parse_vocabulary("[UNK]\na\r\n##s\n") == Words{"[UNK]", "a", "##s"});
  CHECK(ml::parse_vocabulary("a b\n \u3000\nx") == Words{"a b", " \u3000", "x"});
  CHECK(ml::parse_vocabulary("").empty());
  CHECK_ERROR(ml::parse_vocabulary("a\n\nb\n", "v.txt"), "[motionlang.io.403] v.txt:2: an empty line");
  CHECK_ERROR(ml::parse_vocabulary("a\nb\na\n", "v.txt"), "v.txt:3: piece 'a' is duplicated");
  CHECK_ERROR(ml::parse_vocabulary("a\n\xFF\n", "v.txt"), "v.txt:2: not UTF-8");
}

TEST_CASE("merges.txt: two symbols a line up to the first empty one") {
  const ml::BytePairMerges want{{"i", "n"}, {"t", "h</w>"}};
  CHECK(ml::parse_merges("#version: 0.2\ni n\nt h</w>\n\nx y\n") == want);
  CHECK(ml::parse_merges("\"bpe_simple_vocab_16e6.txt#version: 0.2\ni n\nt h</w>\nx y\n", "x", 2) == want);
  CHECK(ml::parse_merges("# #\n") == ml::BytePairMerges{{"#", "#"}});
  for (const char* line : {"i", " n", "i ", "i  n", "i n m"})
    CHECK_ERROR(ml::parse_merges(std::string("a b\n") + line, "m.txt"), "[motionlang.io.403] m.txt:2: '");
  CHECK_ERROR(ml::parse_merges("a b\nc d\na b\n", "m.txt"), "m.txt:3: 'a b' is duplicated");
}

TEST_CASE("gzip: members are unpacked and checked") {
  // printf 'w a\nwa l\n' | gzip -n
  const std::string packed(
      "\x1f\x8b\x08\x00\x00\x00\x00\x00\x00\x03\x2b\x57\x48\xe4\x2a\x4f\x54\xc8\xe1\x02\x00\x3f\x9b"
      "\x5f\xde\x09\x00\x00\x00",
      29);
  const auto unpack = [](const std::string& bytes) { return ml::gunzip(std::as_bytes(std::span(bytes)), "x.gz"); };
  CHECK(unpack(packed) == "w a\nwa l\n");
  // the same with a name, a comment, an extra field and a checksum of the header
  const std::string head("\x1f\x8b\x08\x1e\0\0\0\0\0\x03\x02\0..name\0comment\0xx", 29);
  CHECK(unpack(head + packed.substr(10)) == "w a\nwa l\n");
  const auto changed = [&](std::size_t at, char c) {
    std::string out = packed;
    out[at] = c;
    return out;
  };
  CHECK_ERROR(unpack(changed(0, 'x')), "[motionlang.io.403] x.gz: does not begin as a gzip file");
  CHECK_ERROR(unpack(changed(2, 7)), "[motionlang.io.404] x.gz: gzip method 7");
  CHECK_ERROR(unpack(changed(3, '\x80')), "[motionlang.io.404]");
  CHECK_ERROR(unpack(changed(21, 'x')), "wrong checksum");
  CHECK_ERROR(unpack(changed(25, 8)), "[motionlang.io.405]");
  CHECK_ERROR(unpack(changed(25, 10)), "declares 10 bytes, holds 9");
  CHECK_ERROR(unpack(changed(28, 1)), "[motionlang.io.405] x.gz: declares 16777225 bytes, packed in 11");
  CHECK_ERROR(unpack(packed.substr(0, 15)), "[motionlang.io.402]");
  CHECK_ERROR(unpack(packed.substr(0, 3)), "[motionlang.io.402]");
  CHECK_ERROR(unpack(packed.substr(0, 10) + std::string(1, '\x2b') + packed.substr(21)), "[motionlang.io.40");

  const TemporaryFolder folder;
  ml::write_file(folder / "merges.gz", packed);
  CHECK(ml::read_merges(folder / "merges.gz") == ml::BytePairMerges{{"w", "a"}, {"wa", "l"}});
  CHECK(ml::read_clip_tokenizer(folder / "merges.gz").size() == 516);
}

TEST_CASE("tokenizer.json of BERT") {
  const auto bert = from_json(bert_json);
  REQUIRE(bert.bert() != nullptr);
  CHECK(bert.clip() == nullptr);
  CHECK(bert.size() == 7);
  CHECK(bert.encode("A walks <mask>[UNK] w\u00e4lk walkss walksss") == Ids{1, 5, 3, 4, 6, 0, 3, 3, 4, 4, 0, 2});
  CHECK(bert.decode(bert.encode("a walks")) == "a walks");
  CHECK(bert.bert()->encode_pair("a", "walk").types == Ids{0, 0, 0, 1, 1});
  CHECK(from_json(bert_json, {.stored = true}).encode("a walks a") == Ids{1, 5, 3, 2});
  CHECK(from_json(bert_json, {.longest = 3, .truncate = true, .stored = true}).encode("a walks a") == Ids{1, 5, 2});
  CHECK_ERROR(from_json(bert_json, {.longest = 3}).encode("a walks a"), "[motionlang.config.101]");
  CHECK(from_json(with(bert_json, "\"strip_accents\": null", "\"strip_accents\": false")).encode("w\u00e4lk") ==
        Ids{1, 0, 2});

  const std::string processing =
      bert_json.substr(bert_json.find("{\"type\": \"TemplateProcessing\""),
                       bert_json.find(",\n  \"decoder\"") - bert_json.find("{\"type\": \"TemplateProcessing\""));
  const auto plain =
      from_json(with(bert_json, processing, R"({"type": "BertProcessing", "sep": ["[SEP]", 2], "cls": ["[CLS]", 1]})"));
  CHECK(plain.encode("a walks") == bert.encode("a walks"));
  CHECK(plain.bert()->encode_pair("a", "walk").types == Ids{0, 0, 0, 1, 1});
  const auto roberta = from_json(
      with(bert_json, processing, R"({"type": "RobertaProcessing", "sep": ["[SEP]", 2], "cls": ["[CLS]", 1]})"));
  CHECK(roberta.bert()->encode_pair("a", "walk").ids == Ids{1, 5, 2, 2, 3, 2});
}

TEST_CASE("tokenizer.json of CLIP") {
  const auto clip = from_json(clip_json);
  REQUIRE(clip.clip() != nullptr);
  CHECK(clip.size() == 13);
  CHECK(clip.pad_id() == 12);
  CHECK(clip.encode("Walk <|STARTOFTEXT|> walks<|endoftext|>") == Ids{11, 10, 11, 9, 1, 7, 12, 12});
  CHECK(clip.encode("z a") == Ids{11, 12, 5, 12});  // no symbol for z
  CHECK(clip.decode(Ids{11, 9, 1, 7, 5, 12}) == "walks a");
}

TEST_CASE("tokenizer.json, or vocab.json and merges.txt, of RoBERTa") {
  const auto document = ml::parse_json(roberta_json());
  const auto tokenizer = ml::tokenizer_from_json(ml::JsonView(document));
  REQUIRE(tokenizer.roberta() != nullptr);
  CHECK((tokenizer.bert() == nullptr && tokenizer.clip() == nullptr));
  const auto ids = tokenizer.encode("wa wa<mask>");
  REQUIRE(ids.size() == 6);
  CHECK((ids[0] == 0 && ids[1] == 260 && ids[3] == 260 && ids[4] == 261 && ids[5] == 2));
  CHECK(tokenizer.decode(ids) == "wa wa");
  CHECK((tokenizer.size() == 262 && tokenizer.pad_id() == 1));
  CHECK(ml::tokenizer_from_json(ml::JsonView(document), {.longest = 4, .truncate = true}).encode("wa wa wa").size() ==
        4);

  const auto without = [&](const std::string& part, const std::string& with) {
    std::string text = roberta_json();
    text.replace(text.find(part), part.size(), with);
    const auto changed = ml::parse_json(text);
    return ml::tokenizer_from_json(ml::JsonView(changed));
  };
  CHECK_ERROR(without("RobertaProcessing", "BertProcessing"), "expected RobertaProcessing");
  CHECK_ERROR(without(R"("add_prefix_space": false)", R"("add_prefix_space": true)"), "[motionlang.io.404]");
  CHECK_ERROR(without(R"("normalizer": null)", R"("normalizer": {"type": "NFC"})"), "none for RoBERTa");
  CHECK_ERROR(without(R"("dropout": null)", R"("dropout": 0.1)"), "dropout of merges");

  const TemporaryFolder folder;
  ml::write_file(folder / "vocab.json", document["model"]["vocab"].dump());
  ml::write_file(folder / "merges.txt", std::string_view("#version: 0.2\nw a\n"));
  const auto read = ml::read_tokenizer(folder.path);
  REQUIRE(read.roberta() != nullptr);
  CHECK(read.encode("wa wa") == tokenizer.encode("wa wa"));
}

TEST_CASE("tokenizer.json: what is not known is refused by its name") {
  const auto refused = [](const std::string& text, std::string_view part, std::string_view other, const char* message) {
    CAPTURE(other);
    CHECK_ERROR(from_json(with(text, part, other)), message);
  };
  refused(bert_json, "\"WordPiece\", \"unk", "\"Unigram\", \"unk",
          "[motionlang.io.404] tokenizer.json: model: type Unigram, expected WordPiece, BPE");
  refused(bert_json, "BertNormalizer", "NFKC", "normalizer: type NFKC, expected BertNormalizer");
  refused(bert_json, "BertPreTokenizer", "Whitespace", "pre_tokenizer: type Whitespace");
  refused(bert_json, "TemplateProcessing", "ByteLevel", "post_processor: type ByteLevel");
  refused(bert_json, "\"single_word\": false", "\"single_word\": true", "added_tokens[0]: 'single_word'");
  refused(bert_json, "\"id\": \"A\"", "\"id\": \"C\"", "text 'C'");
  refused(clip_json, "NFC", "NFD", "normalizer.normalizers[0]: type NFD, expected NFC");
  refused(clip_json, "{\"type\": \"Lowercase\"}", "{\"type\": \"Lowercase\"}, {\"type\": \"Strip\"}",
          "normalizers[3]: type Strip");
  refused(clip_json, "\"Regex\": \"\\\\s+\"", "\"Regex\": \"x\"", "'Regex' has an unsupported value");
  refused(clip_json, "[\\\\p{N}]", "[\\\\p{N}]+", "another pattern than that of CLIP");
  refused(clip_json, "\"add_prefix_space\": false", "\"add_prefix_space\": true", "'add_prefix_space'");
  refused(clip_json, "\"ByteLevel\"", "\"Digits\"", "pretokenizers[1]: type Digits");
  refused(clip_json, "\"dropout\": null", "\"dropout\": 0.1", "[motionlang.io.404]");
  refused(clip_json, "\"fuse_unk\": false", "\"byte_fallback\": true", "'byte_fallback'");
}

TEST_CASE("tokenizer.json: what does not fit together is refused") {
  const auto refused = [](const std::string& text, std::string_view part, std::string_view other, const char* message) {
    CAPTURE(other);
    CHECK_ERROR(from_json(with(text, part, other)), message);
  };
  refused(bert_json, "\"a\": 5", "\"a\": 4", "'##s' and 'a' have the same id 4");
  refused(bert_json, "\"a\": 5", "\"a\": 7",
          "[motionlang.io.403] tokenizer.json: model.vocab: 'a' has id 7 among 7 pieces");
  refused(bert_json, "\"a\": 5", "\"a\": \"5\"", "the id of 'a' is not an integer");
  refused(bert_json, "\"ids\": [1]", "\"ids\": [9]",
          "[motionlang.config.107] tokenizer.json: post_processor: id 9 among 7 pieces");
  refused(bert_json, "\"ids\": [1]", "\"ids\": []", "does not begin and end with a token");
  refused(bert_json, "\"unk_token\": \"[UNK]\"", "\"unk_token\": \"<unk>\"", "lacks '<unk>'");
  refused(clip_json, "\"w a\"", "\"w\"", "tokenizer.json: model.merges:0: 'w' is not two symbols");
  refused(clip_json, "[\"wa\", \"l\"]", "[\"wa\"]", "model.merges[1]: 1 symbol");
  refused(clip_json, "\"w a\"", "\"w x\"", "merge 0: 'x' is not a piece");
  CHECK_ERROR(from_json("{}"), "[motionlang.config.107] tokenizer.json: has no member 'model'");
}

TEST_CASE("tokenizer_config.json") {
  const auto document =
      ml::parse_json(R"({"do_lower_case": false, "strip_accents": null, "tokenize_chinese_chars": true,
    "model_max_length": 384, "tokenizer_class": "MPNetTokenizer", "cls_token": "<s>",
    "mask_token": {"content": "<mask>", "lstrip": true}, "unk_token": null})");
  const auto config = ml::tokenizer_config_from_json(ml::JsonView(document));
  CHECK(config.tokenizer_class == "MPNetTokenizer");
  CHECK(config.lower_case == false);
  CHECK(!config.strip_accents);
  CHECK(config.split_cjk == true);
  CHECK(config.longest == 384);
  CHECK(config.tokens == std::map<std::string, std::string>{{"cls_token", "<s>"}, {"mask_token", "<mask>"}});
  const auto endless = ml::parse_json(R"({"model_max_length": 1000000000000000019884624838656})");
  CHECK(!ml::tokenizer_config_from_json(ml::JsonView(endless)).longest);
}

TEST_CASE("folders: tokenizer.json, else vocab.txt, else vocab.json and merges.txt") {
  const TemporaryFolder folder;
  CHECK_ERROR(ml::read_tokenizer(folder.path), "[motionlang.io.401]");

  std::string vocabulary = R"({"<|startoftext|>": 512, "<|endoftext|>": 513)";
  const auto symbols = ml::ClipTokenizer(ml::BytePairMerges{}).vocabulary();
  for (std::size_t i = 0; i < 512; ++i)
    vocabulary += ", " + nlohmann::json(symbols[i]).dump() + ": " + std::to_string(i);
  ml::write_file(folder / "vocab.json", vocabulary + R"(, "wa": 514})");
  ml::write_file(folder / "merges.txt", "#version: 0.2\nw a\n");
  const auto clip = ml::read_tokenizer(folder.path);
  CHECK(clip.encode("wal").front() == 512);
  CHECK(clip.encode("wal").at(1) == 514);
  CHECK(clip.clip()->options().cleaning == ml::ClipCleaning::hugging_face);
  const auto original = ml::read_tokenizer(folder.path, {.cleaning = ml::ClipCleaning::original});
  CHECK(original.clip()->options().cleaning == ml::ClipCleaning::original);
  CHECK(original.encode("wa&amp;l") == original.encode("wa&l"));  // entities are resolved
  CHECK(clip.encode("wa&amp;l") != clip.encode("wa&l"));

  ml::write_file(folder / "vocab.txt", "<s>\n<pad>\n</s>\n<unk>\n[UNK]\nWalk\nwalk\n<mask>\n");
  CHECK(ml::read_tokenizer(folder.path).encode("Walk x") == Ids{0, 6, 4, 2});  // known by its marks
  ml::write_file(folder / "tokenizer_config.json", R"({"tokenizer_class": "MPNetTokenizer", "do_lower_case": false,
    "cls_token": "<s>", "sep_token": "</s>", "unk_token": "[UNK]", "mask_token": "<mask>"})");
  const auto mpnet = ml::read_tokenizer(folder.path);
  CHECK(mpnet.encode("Walk walk <mask> x") == Ids{0, 5, 6, 7, 4, 2});
  CHECK(mpnet.pad_id() == 1);

  ml::write_file(folder / "tokenizer.json", bert_json);
  CHECK(ml::read_tokenizer(folder.path).size() == 7);
}
