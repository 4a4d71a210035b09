// Files of tokenizers, config.json of text networks, and the texts that they meet. The first byte says what an input
// is, so that each run does one thing: '{' JSON, '#' or '"' merges.txt, '[' or '<' vocab.txt, 0x1F gzip; a text may
// follow a file, behind a NUL. Anything else is a text behind one byte that chooses what takes it. Any file is read or
// refused with an error of the library; any text gets ids of the vocabulary.
#include <cstdint>

#include <motionlang/file/gzip.hpp>
#include <motionlang/file/json.hpp>
#include <motionlang/text/text_repair.hpp>
#include <motionlang/text/unicode.hpp>
#include <motionlang/weights/text_network_file.hpp>
#include <motionlang/weights/tokenizer_json.hpp>

#include "check.hpp"

namespace {

namespace ml = motionlang;

template <class T>
void check_text(const T& tokenizer, std::string_view text) {
  const auto ids = tokenizer.encode_words(text);
  for (const ml::Index id : ids) check(id >= 0 && id < tokenizer.size(), "ids of the vocabulary");
  tokenizer.decode(ids);
  check(tokenizer.encode_words(text) == ids, "the same ids again");
}

void check_unicode(std::string_view text) {
  const std::u32string raw = ml::to_utf32(text), together = ml::nfc(raw), apart = ml::nfd(raw);
  check(ml::nfc(together) == together && ml::nfd(apart) == apart, "normal forms are normal");
  check(ml::nfc(apart) == together && ml::nfd(together) == apart, "normal forms agree");
  check(ml::is_utf8(ml::repair_text(text)), "repaired texts are UTF-8");
  ml::html_unescape(text);
}

void check_json(std::string_view file, std::string_view text) {
  const auto document = ml::parse_json(file);
  const ml::JsonView view(document);
  if (!view.contains("model")) {
    refusing([&] { ml::tokenizer_config_from_json(view); });
    refusing([&] { ml::detail::pieces_by_id(view); });
    for (const char* type : {"distilbert", "bert", "mpnet"}) refusing([&] { ml::bert_config(view, type); });
    refusing([&] { ml::clip_text_config(view); });
    return;
  }
  const auto tokenizer = ml::tokenizer_from_json(view, {.stored = true});
  if (tokenizer.bert() != nullptr) check_text(*tokenizer.bert(), text);
  if (tokenizer.clip() != nullptr) check_text(*tokenizer.clip(), text);
  check(std::ssize(tokenizer.encode(text)) >= 2, "a frame");
}

void check_any_text(unsigned way, std::string_view text) {
  static const ml::BytePairMerges few{{"w", "a"}, {"wa", "l"}, {"a", "a"}, {"aa", "a"}, {"k", "s</w>"}};
  static const ml::ClipTokenizer clip(few);
  static const ml::ClipTokenizer clip_hf(few, {.cleaning = ml::ClipCleaning::hugging_face});
  static const ml::BertTokenizer bert({"[UNK]", "[CLS]", "[SEP]", "[MASK]", "a", "##a", "walk", "##s", "\u1102", "."},
                                      {.strip_accents = {}, .longest_word = 32});
  if (way == 0) check_unicode(text);
  if (way == 1) check_text(clip, text);
  if (way == 2) check_text(clip_hf, text);
  if (way == 3) check_text(bert, text);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view all(reinterpret_cast<const char*>(data), size);
  const std::size_t end = std::min(all.find('\0'), size);
  constexpr std::size_t longest = 72;  // bytes of a text; words are remembered up to 64
  const std::string_view file = all.substr(0, end), text = all.substr(std::min(end + 1, size)).substr(0, longest);
  switch (data[0]) {
    case '{':
      refusing([&] { check_json(file, text); });
      break;
    case '#':
    case '"':
      refusing([&] { check_text(ml::ClipTokenizer(ml::parse_merges(file)), text); });
      break;
    case '[':
    case '<':
      refusing([&] { check_text(ml::BertTokenizer(ml::parse_vocabulary(file)), text); });
      break;
    case 0x1F:
      refusing([&] { ml::gunzip(std::as_bytes(std::span(all))); });
      break;
    default:
      check_any_text(data[0] % 4, all.substr(1).substr(0, longest));
  }
  return 0;
}
