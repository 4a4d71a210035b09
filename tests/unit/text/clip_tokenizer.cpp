// CLIP's tokenizer with a few merges: ids, cleaning, frames, threads. The repair of texts.
#include <motionlang/text/clip_tokenizer.hpp>
#include <motionlang/text/detail/byte_symbols.hpp>
#include <motionlang/text/text_repair.hpp>

#include <thread>

#include "../../support/check_error.hpp"

namespace ml = motionlang;
using ml::ClipTokenizer, ml::ClipTokenizerOptions, ml::Index;
using Ids = std::vector<Index>;

namespace {

const ml::BytePairMerges merges{{"w", "a"},        {"wa", "l"},        {"wal", "k</w>"}, {"k", "s</w>"},
                                {"wal", "ks</w>"}, {"p", "e"},         {"r", "s"},       {"pe", "rs"},
                                {"o", "n</w>"},    {"pers", "on</w>"}, {"!", "!"},       {"\u00C3", "\u00A9</w>"},
                                {"l", "k</w>"}};

/// Merges pair after pair over the whole word, as the definition says.
Ids merged_slowly(const ClipTokenizer& clip, const ml::BytePairMerges& pairs, std::string_view word) {
  std::vector<std::string> parts;
  for (const char c : word) parts.push_back(ml::detail::ByteSymbols::get().symbol[static_cast<unsigned char>(c)]);
  parts.back() += "</w>";
  for (;;) {
    std::size_t best = pairs.size();
    for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
      const auto found = std::find(pairs.begin(), pairs.end(), std::pair(parts[i], parts[i + 1]));
      best = std::min(best, static_cast<std::size_t>(found - pairs.begin()));
    }
    if (best == pairs.size()) break;
    std::vector<std::string> next;
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const bool both = i + 1 < parts.size() && std::pair(parts[i], parts[i + 1]) == pairs[best];
      next.push_back(both ? parts[i] + parts[i + 1] : parts[i]);
      i += both;
    }
    parts = next;
  }
  Ids ids;
  const auto& all = clip.vocabulary();
  for (const std::string& part : parts) ids.push_back(std::find(all.begin(), all.end(), part) - all.begin());
  return ids;
}

}  // namespace

TEST_CASE("ClipTokenizer: ids of the original implementation") {
  const ClipTokenizer clip(merges);
  CHECK(clip.size() == 527);
  CHECK(clip.begin_id() == 525);
  CHECK(clip.end_id() == 526);
  CHECK(clip.pad_id() == 0);
  const std::pair<std::string, Ids> rows[] = {
      {"a person walks", {320, 521, 516}},
      {"Walk!!! walk", {514, 522, 256, 514}},
      {"caf\u00e9 walking", {66, 64, 69, 523, 513, 74, 72, 77, 326}},
      {"person's 12", {521, 6, 338, 272, 273}},
      {"pers", {517, 81, 338}},
      {"walk<|endoftext|>", {514, 526}},
      {"", {}},
      {" \t\n", {}},
      {"walk\u3000WALK", {514, 514}},
      {"&lt;", {283}},
      {"'\u017F", {6, 129, 379}},      // a long s is an s without case
      {"walk\u0345walk", {514, 514}},  // lost, see append_words
  };
  for (const auto& row : rows) {
    CAPTURE(row.first);
    const auto& [text, ids] = row;
    CHECK(clip.encode_words(text) == ids);
    Ids framed{525};
    framed.insert(framed.end(), ids.begin(), ids.end());
    framed.push_back(526);
    CHECK(clip.encode(text) == framed);
  }
}

TEST_CASE("ClipTokenizer: merges in the order of the definition, whatever the ranks") {
  // Ranks that no learning would give: a longer piece before its parts, pairs of equals, chains.
  const ml::BytePairMerges odd{{"ab", "c"}, {"a", "a"}, {"a", "b"},      {"aa", "a"}, {"b", "a"},
                               {"aa", "b"}, {"b", "b"}, {"bb", "b</w>"}, {"aa", "aa"}};
  std::vector<std::string> pieces;
  const ClipTokenizer letters(ml::BytePairMerges{});
  pieces = letters.vocabulary();
  for (const char* p : {"abc", "aa", "ab", "aaa", "ba", "aab", "bb", "bbb</w>", "aaaa"}) pieces.emplace_back(p);
  ClipTokenizerOptions options;
  options.cached_words = 0;
  const ClipTokenizer clip(pieces, odd, options);
  std::uint32_t state = 1;
  for (int i = 0; i < 5000; ++i) {
    std::string word;
    for (std::uint32_t k = 0; k < 1 + state % 17; ++k) {
      state = state * 1664525u + 1013904223u;
      word += "abc"[(state >> 24) % 3];
    }
    REQUIRE_MESSAGE(clip.encode_words(word) == merged_slowly(clip, odd, word), word);
    state = state * 1664525u + 1013904223u;
  }
}

TEST_CASE("ClipTokenizer: the memory of words changes nothing, also when it is full and among threads") {
  ClipTokenizerOptions options;
  options.cached_words = 2;
  const ClipTokenizer small(merges, options), large(merges);
  const std::string text = "a person walks, a person walks!! pers walk " + std::string(100, 'w') + " walk";
  const Ids want = large.encode_words(text);
  for (int i = 0; i < 3; ++i) CHECK(small.encode_words(text) == want);
  std::vector<Ids> got(4);
  std::vector<std::thread> threads;
  for (Ids& ids : got) {
    threads.emplace_back([&] {
      for (int i = 0; i < 200; ++i) ids = small.encode_words(text);
    });
  }
  for (std::thread& t : threads) t.join();
  for (const Ids& ids : got) CHECK(ids == want);
}

TEST_CASE("ClipTokenizer: a long word costs little") {
  const ClipTokenizer clip(merges);
  CHECK(clip.encode_words(std::string(200000, 'w')).size() == 200000);
  std::string walks;
  while (walks.size() < 200000) walks += "walk";
  CHECK(clip.encode_words(walks).size() == 50000 * 2 - 1);  // wal k wal k ... wal+k</w>
}

TEST_CASE("ClipTokenizer: long texts lose their last words or are refused") {
  ClipTokenizerOptions options;
  options.longest = 4;
  CHECK(ClipTokenizer(merges, options).encode("walk walk walk walk") == Ids{525, 514, 514, 526});
  options.truncate = false;
  CHECK_ERROR(ClipTokenizer(merges, options).encode("walk walk walk"),
              "[motionlang.config.101] ClipTokenizer: a text of 5 ids, at most 4");
  options.longest = 1;
  CHECK_ERROR(ClipTokenizer(merges, options), "[motionlang.config.101]");
}

TEST_CASE("ClipTokenizer: as Hugging Face has it") {
  ClipTokenizerOptions options;
  options.cleaning = ml::ClipCleaning::hugging_face;
  const ClipTokenizer clip(merges, options), original(merges);
  CHECK(clip.pad_id() == 526);
  CHECK(clip.encode("A  person walks") == original.encode("a person walks"));
  CHECK(clip.cleaned("&amp; \u201Ca\u201D \uFB01 \u039F\u03A3 e\u0301") ==
        "&amp; \u201Ca\u201D \uFB01 \u03BF\u03C3 \u00e9");
  CHECK(original.cleaned("&amp; \u201Ca\u201D \uFB01 \u039F\u03A3 e\u0301") == "& \"a\" fi \u03BF\u03C2 \u00e9");
}

TEST_CASE("ClipTokenizer: decoding") {
  const ClipTokenizer clip(merges);
  CHECK(clip.decode(clip.encode("A person walks caf\u00e9!!")) == "a person walks caf\u00e9 !!");
  CHECK(clip.decode(Ids{513}) == "wal");
  CHECK_ERROR(clip.decode(Ids{527}), "[motionlang.shape.203]");
}

TEST_CASE("ClipTokenizer: vocabularies that cannot work") {
  CHECK_ERROR(ClipTokenizer(ml::BytePairMerges{{"w", "xyz"}}),
              "[motionlang.config.107] ClipTokenizer: merge 0: 'xyz' is not a piece");
  CHECK_ERROR(ClipTokenizer(ml::BytePairMerges{{"w", "a"}, {"w", "a"}}), "is duplicated");
  CHECK_ERROR(ClipTokenizer(std::vector<std::string>{"a"}, {}), "1 pieces lack '<|startoftext|>'");
  ClipTokenizerOptions options;
  options.unknown = "";
  CHECK_ERROR(ClipTokenizer(std::vector<std::string>{"<|startoftext|>", "<|endoftext|>"}, {}, options),
              "no piece for byte 0");
  const ClipTokenizer few(std::vector<std::string>{"<|startoftext|>", "<|endoftext|>", "a", "b</w>"}, {});
  CHECK(few.encode_words("abb") == Ids{2, 1, 3});  // a byte without a symbol is unknown
}

TEST_CASE("repair_text: each of its steps") {
  const std::pair<std::string, std::string> rows[] = {
      {"plain & simple", "plain & simple"},
      {"&lt;b&gt; &eacute;&NTILDE; &#233; &#xE9; &amp;amp;", "<b> \u00e9\u00d1 \u00e9 \u00e9 &"},
      {"&eacute &bogus; &#; &#59;", "&eacute &bogus; &#; &#59;"},
      {"a<b &amp;", "a<b &amp;"},
      {"&amp;\n<\n&amp;", "&\n<\n&amp;"},
      {"\u0080\u0085\u0081", "\u20AC\u2026\u0081"},
      {"\uFB01\u0133\u0149\u01C5\uFB05", "fiij'nD\u017E\u017Ft"},
      {"\u3000\uFF21\uFF76\uFFE3x", " A\u30AB \u0304x"},
      {"\u2018a\u201B \u201Cb\u201F \u02BC", "'a' \"b\" '"},
      {"a\r\nb\rc\u2028d\u2029e", "a\nb\nc\nd\ne"},
      {"a\x1B[1;31mb\x1B[c\x1B(d", "ab(d"},
      {std::string("a\0\x01\x0B\x7F\uFEFF\uFFF9b\t\x0C", 14), "ab\t\x0C"},
      {"e\u0301", "\u00e9"},
      {"\xFF", "\uFFFD"},
      {"", ""},
  };
  for (const auto& row : rows) {
    CAPTURE(row.first);
    const auto& [text, want] = row;
    CHECK(ml::repair_text(text) == want);
  }
}

TEST_CASE("html_unescape: as HTML5 has it") {
  const std::pair<std::string, std::string> rows[] = {
      {"&amp", "&"},
      {"&ampx &notit; &notin; &copy2", "&x \u00acit; \u2209 \u00a92"},
      {"&NTILDE; &unknown; & &; &#", "&NTILDE; &unknown; & &; &#"},
      {"&#65&#x42;&#X43", "ABC"},
      {"&#0; &#xD800; &#x110000; &#99999999999999999999;", "\uFFFD \uFFFD \uFFFD \uFFFD"},
      {"&#128;&#133;&#129;&#1;&#x7F;&#xFFFE;&#13;", "\u20AC\u2026\u0081\r"},
      {"&NotEqualTilde;&bne;", "\u2242\u0338=\u20e5"},
      {"&amp;lt;", "&lt;"},
  };
  for (const auto& row : rows) {
    CAPTURE(row.first);
    const auto& [text, want] = row;
    CHECK(ml::html_unescape(text) == want);
  }
}
