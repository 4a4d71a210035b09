// SPDX-License-Identifier: MIT
// Bodies of tokenizer_json.hpp.
#pragma once

#include <tuple>  // tie

#include <motionlang/file/json.hpp>
#include <motionlang/weights/tokenizer_json.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Throws io_error 404: the file asks for an unsupported kind.
[[noreturn]] inline void unknown_kind(const JsonView& view, std::string_view wanted) {
  const std::string found = view.contains("type") && view["type"].is_string() ? view["type"].as<std::string>() : "none";
  raise<io_error>(404, view.path(), ": type ", utf8_head(found, 40), ", expected ", wanted);
}

inline bool has_type(const JsonView& view, std::string_view type) {
  return view.contains("type") && view["type"].is_string() && view["type"].as<std::string>() == type;
}

/// Throws io_error 404 unless the member is missing or has the only supported value.
template <class T>
void require_value(const JsonView& view, const std::string& key, const T& value) {
  if (view.value_or(key, value) != value) raise<io_error>(404, view.path(), ": '", key, "' has an unsupported value");
}

MOTIONLANG_BODY std::vector<std::string> pieces_by_id(const JsonView& vocabulary, std::span<const AddedToken> added) {
  if (!vocabulary.is_object()) raise<config_error>(107, vocabulary.path(), ": expected an object of pieces and ids");
  std::size_t count = vocabulary.json().size();
  for (const AddedToken& t : added) count += !vocabulary.contains(t.content);
  std::vector<std::string> pieces(count);
  std::vector<bool> taken(count);
  const auto put = [&](const std::string& piece, Index id) {
    const auto at = static_cast<std::size_t>(id);
    if (id < 0 || at >= count)
      raise<io_error>(403, vocabulary.path(), ": '", piece, "' has id ", id, " among ", counted(count, "piece"));
    if (taken[at] && pieces[at] != piece)
      raise<io_error>(403, vocabulary.path(), ": '", pieces[at], "' and '", piece, "' have the same id ", id);
    taken[at] = true;
    pieces[at] = piece;
  };
  for (const auto& [piece, id] : vocabulary.json().items()) {
    if (!id.is_number_integer() || !std::in_range<Index>(id.get<std::int64_t>()))
      raise<config_error>(107, vocabulary.path(), ": the id of '", piece, "' is not an integer");
    put(piece, static_cast<Index>(id.get<std::int64_t>()));
  }
  for (const AddedToken& t : added) put(t.content, t.id);
  if (const auto hole = std::find(taken.begin(), taken.end(), false); hole != taken.end())
    raise<io_error>(403, vocabulary.path(), ": no piece has id ", hole - taken.begin(), ", others are duplicated");
  return pieces;
}

MOTIONLANG_BODY std::vector<AddedToken> added_tokens(const JsonView& document) {
  std::vector<AddedToken> out;
  if (!document.contains("added_tokens")) return out;
  const JsonView list = document["added_tokens"];
  for (Index i = 0; i < list.size(); ++i) {
    const JsonView t = list[i];
    require_value(t, "single_word", false);
    out.push_back({t["content"].as<std::string>(), t["id"].as<Index>(), t.value_or("normalized", false)});
  }
  return out;
}

struct Frames {
  std::vector<FramePart> single, pair;
};

inline std::vector<FramePart> template_frame(const JsonView& parts, const JsonView& specials) {
  std::vector<FramePart> out;
  for (Index i = 0; i < parts.size(); ++i) {
    if (parts[i].contains("Sequence")) {
      const JsonView text = parts[i]["Sequence"];
      const auto name = text["id"].as<std::string>();
      if (name != "A" && name != "B") raise<io_error>(404, text.path(), ": text '", name, "', expected A or B");
      out.push_back({name == "A" ? FramePart::text_a : FramePart::text_b, 0, text["type_id"].as<Index>()});
      continue;
    }
    const JsonView token = parts[i]["SpecialToken"];
    for (const Index id : specials[token["id"].as<std::string>()]["ids"].as<std::vector<Index>>())
      out.push_back({FramePart::token, id, token["type_id"].as<Index>()});
  }
  return out;
}

inline Frames read_frames(const JsonView& view) {
  using enum FramePart::Kind;
  if (has_type(view, "TemplateProcessing"))
    return {template_frame(view["single"], view["special_tokens"]),
            template_frame(view["pair"], view["special_tokens"])};
  const bool bert = has_type(view, "BertProcessing");
  if (!bert && !has_type(view, "RobertaProcessing"))
    unknown_kind(view, "TemplateProcessing, BertProcessing, RobertaProcessing");
  const Index begin = view["cls"][1].as<Index>(), end = view["sep"][1].as<Index>(), second = bert ? 1 : 0;
  Frames out{{{token, begin}, {text_a}, {token, end}}, {{token, begin}, {text_a}, {token, end}}};
  if (!bert) out.pair.push_back({token, end});
  out.pair.insert(out.pair.end(), {{text_b, 0, second}, {token, end, second}});
  return out;
}

/// The pieces of the first and the last id of a frame. Throws io_error 404 if it does not begin and end with one.
inline std::pair<std::string, std::string> frame_ends(const Frames& frames, const std::vector<std::string>& pieces,
                                                      const JsonView& view) {
  const auto& f = frames.single;
  const auto piece = [&](const FramePart& part) -> std::string {
    if (part.id < 0 || part.id >= std::ssize(pieces))
      raise<config_error>(107, view.path(), ": id ", part.id, " among ", counted(pieces.size(), "piece"));
    return pieces[static_cast<std::size_t>(part.id)];
  };
  if (f.size() < 3 || f.front().kind != FramePart::token || f.back().kind != FramePart::token)
    raise<io_error>(404, view.path(), ": a frame that does not begin and end with a token");
  return {piece(f.front()), piece(f.back())};
}

template <class Options>
void set_limits(Options& options, const JsonView& document, const TokenizerLimits& limits) {
  if (limits.stored && document.contains("truncation") && document["truncation"].is_object()) {
    options.longest = document["truncation"]["max_length"].as<Index>();
    options.truncate = true;
  }
  options.longest = limits.longest.value_or(options.longest);
  options.truncate = limits.truncate.value_or(options.truncate);
}

inline BertTokenizer bert_from_json(const JsonView& document, const TokenizerLimits& limits) {
  const JsonView model = document["model"], normalizer = document["normalizer"], post = document["post_processor"];
  if (!has_type(normalizer, "BertNormalizer")) unknown_kind(normalizer, "BertNormalizer");
  if (!has_type(document["pre_tokenizer"], "BertPreTokenizer"))
    unknown_kind(document["pre_tokenizer"], "BertPreTokenizer");
  BertTokenizerOptions o;
  o.clean_text = normalizer.value_or("clean_text", true);
  o.split_cjk = normalizer.value_or("handle_chinese_chars", true);
  o.lower_case = normalizer.value_or("lowercase", true);
  if (normalizer.contains("strip_accents") && !normalizer["strip_accents"].is_null())
    o.strip_accents = normalizer["strip_accents"].as<bool>();
  o.unknown = model.value_or("unk_token", "[UNK]");
  o.continuation = model.value_or("continuing_subword_prefix", "##");
  o.longest_word = model.value_or("max_input_chars_per_word", Index{100});
  set_limits(o, document, limits);
  const auto added = added_tokens(document);
  auto pieces = pieces_by_id(model["vocab"], added);
  Frames frames = read_frames(post);
  std::tie(o.begin, o.end) = frame_ends(frames, pieces, post);
  if (std::find(pieces.begin(), pieces.end(), "<pad>") != pieces.end()) o.pad = "<pad>";
  BertTokenizer out(std::move(pieces), std::move(o), document.path(), added);
  out.set_frames(std::move(frames.single), std::move(frames.pair), document.path());
  return out;
}

/// The patterns by which CLIP finds words.
inline bool is_clip_pattern(std::string_view pattern) {
  constexpr std::string_view marks = R"(<\|startoftext\|>|<\|endoftext\|>|)";
  if (pattern.starts_with(marks)) pattern.remove_prefix(marks.size());
  return pattern == R"('s|'t|'re|'ve|'m|'ll|'d|[\p{L}]+|[\p{N}]|[^\s\p{L}\p{N}]+)";
}

inline void require_clip_steps(const JsonView& document) {
  const JsonView normalizer = document["normalizer"], splitter = document["pre_tokenizer"];
  if (!has_type(normalizer, "Sequence")) unknown_kind(normalizer, "Sequence of NFC, Replace, Lowercase");
  const JsonView steps = normalizer["normalizers"];
  const std::vector<std::string> known{"NFC", "Replace", "Lowercase"};
  for (Index i = 0; i < std::max<Index>(steps.size(), 3); ++i) {
    if (i >= 3 || !has_type(steps[i], known[static_cast<std::size_t>(i)]))
      unknown_kind(steps[i], i < 3 ? known[static_cast<std::size_t>(i)] : "NFC, Replace, Lowercase and no more");
  }
  require_value(steps[1]["pattern"], "Regex", std::string("\\s+"));
  require_value(steps[1], "content", std::string(" "));

  if (!has_type(splitter, "Sequence")) unknown_kind(splitter, "Sequence of Split, ByteLevel");
  const JsonView parts = splitter["pretokenizers"];
  if (!has_type(parts[0], "Split")) unknown_kind(parts[0], "Split");
  if (!has_type(parts[1], "ByteLevel")) unknown_kind(parts[1], "ByteLevel");
  if (parts.size() > 2) unknown_kind(parts[2], "Split, ByteLevel and no more");
  if (!is_clip_pattern(parts[0]["pattern"]["Regex"].as<std::string>()))
    raise<io_error>(404, parts[0].path(), ": another pattern than that of CLIP");
  require_value(parts[0], "behavior", std::string("Removed"));
  require_value(parts[0], "invert", true);
  require_value(parts[1], "add_prefix_space", false);
}

/// An array of "a b" in older files, of ["a", "b"] in newer ones.
inline BytePairMerges merges_from_json(const JsonView& list) {
  BytePairMerges merges;
  for (Index i = 0; i < list.size(); ++i) {
    const JsonView merge = list[i];
    if (merge.is_string())
      merges.push_back(parse_merge(merge.as<std::string>(), list.path(), i));
    else if (merge.size() == 2)
      merges.emplace_back(merge[0].as<std::string>(), merge[1].as<std::string>());
    else
      raise<io_error>(403, merge.path(), ": ", counted(merge.size(), "symbol"), ", a merge has 2");
  }
  return merges;
}

inline ClipTokenizer clip_from_json(const JsonView& document, const TokenizerLimits& limits) {
  const JsonView model = document["model"], post = document["post_processor"];
  require_clip_steps(document);
  require_value(model, "byte_fallback", false);
  require_value(model, "ignore_merges", false);
  require_value(model, "continuing_subword_prefix", std::string());
  if (model.contains("dropout") && !model["dropout"].is_null())
    raise<io_error>(404, model.path(), ": dropout of merges");
  ClipTokenizerOptions o;
  o.cleaning = limits.cleaning;
  o.word_end = model.value_or("end_of_word_suffix", "");
  o.unknown = model.value_or("unk_token", "");
  set_limits(o, document, limits);
  const auto added = added_tokens(document);
  auto pieces = pieces_by_id(model["vocab"], added);
  Frames frames = read_frames(post);
  std::tie(o.begin, o.end) = frame_ends(frames, pieces, post);
  ClipTokenizer out(std::move(pieces), merges_from_json(model["merges"]), std::move(o), document.path(), added);
  out.set_frames(std::move(frames.single), std::move(frames.pair), document.path());
  return out;
}

inline RobertaTokenizer roberta_from_json(const JsonView& document, const TokenizerLimits& limits) {
  const JsonView model = document["model"], splitter = document["pre_tokenizer"], post = document["post_processor"];
  if (document.contains("normalizer") && !document["normalizer"].is_null())
    unknown_kind(document["normalizer"], "none for RoBERTa");
  require_value(splitter, "add_prefix_space", false);
  require_value(splitter, "use_regex", true);
  if (!has_type(post, "RobertaProcessing")) unknown_kind(post, "RobertaProcessing");
  require_value(model, "byte_fallback", false);
  require_value(model, "ignore_merges", false);
  for (const char* key : {"continuing_subword_prefix", "end_of_word_suffix"}) require_value(model, key, std::string());
  if (model.contains("dropout") && !model["dropout"].is_null())
    raise<io_error>(404, model.path(), ": dropout of merges");
  RobertaTokenizerOptions o;
  o.begin = post["cls"][0].as<std::string>(), o.end = post["sep"][0].as<std::string>();
  set_limits(o, document, limits);
  const auto added = added_tokens(document);
  o.special.clear();
  for (const AddedToken& t : added) o.special.push_back(t.content);
  return RobertaTokenizer(pieces_by_id(model["vocab"], added), merges_from_json(model["merges"]), std::move(o),
                          document.path());
}

}  // namespace detail

MOTIONLANG_BODY AnyTokenizer tokenizer_from_json(const JsonView& document, const TokenizerLimits& limits) {
  const JsonView model = document["model"];
  if (detail::has_type(model, "WordPiece")) return detail::bert_from_json(document, limits);
  if (detail::has_type(model, "BPE") && detail::has_type(document["pre_tokenizer"], "ByteLevel"))
    return detail::roberta_from_json(document, limits);
  if (detail::has_type(model, "BPE")) return detail::clip_from_json(document, limits);
  detail::unknown_kind(model, "WordPiece, BPE");
}

MOTIONLANG_BODY AnyTokenizer read_tokenizer_json(const FilePath& path, const TokenizerLimits& limits) {
  const auto document = read_json(path);
  return tokenizer_from_json(JsonView(document, path.string()), limits);
}

MOTIONLANG_BODY std::vector<std::string> read_vocabulary_json(const FilePath& path) {
  const auto document = read_json(path);
  return detail::pieces_by_id(JsonView(document, path.string()));
}

MOTIONLANG_BODY TokenizerConfig tokenizer_config_from_json(const JsonView& view) {
  TokenizerConfig out;
  const auto flag = [&](const std::string& key) -> std::optional<bool> {
    return view.contains(key) && !view[key].is_null() ? std::optional(view[key].as<bool>()) : std::nullopt;
  };
  out.tokenizer_class = view.value_or("tokenizer_class", "");
  out.lower_case = flag("do_lower_case");
  out.strip_accents = flag("strip_accents");
  out.split_cjk = flag("tokenize_chinese_chars");
  if (view.value_or("model_max_length", 1e30) < 1e9) out.longest = view["model_max_length"].as<Index>();
  for (const std::string& key : view.keys()) {
    if (!key.ends_with("_token")) continue;
    if (view[key].is_string()) out.tokens[key] = view[key].as<std::string>();
    if (view[key].is_object()) out.tokens[key] = view[key]["content"].as<std::string>();
  }
  return out;
}

namespace detail {

inline BertTokenizer bert_from_folder(const std::string& folder, const TokenizerConfig& config,
                                      const TokenizerLimits& limits) {
  std::vector<std::string> vocabulary = read_vocabulary(folder + "/vocab.txt");
  const std::vector<std::string> marks = mpnet_vocabulary({});  // the last one stands at the end
  const bool mpnet =
      config.tokenizer_class.starts_with("MPNet") ||
      (vocabulary.size() >= marks.size() && std::equal(marks.begin(), marks.end() - 1, vocabulary.begin()));
  BertTokenizerOptions o = mpnet ? BertTokenizerOptions::mpnet() : BertTokenizerOptions();
  o.lower_case = config.lower_case.value_or(o.lower_case);
  o.strip_accents = config.strip_accents;
  o.split_cjk = config.split_cjk.value_or(o.split_cjk);
  const std::pair<const char*, std::string*> names[] = {
      {"cls_token", &o.begin}, {"sep_token", &o.end}, {"pad_token", &o.pad}};
  for (const auto& [key, name] : names) {
    if (const auto found = config.tokens.find(key); found != config.tokens.end()) *name = found->second;
  }
  // MPNet's own unknown token differs from that of its words.
  if (const auto found = config.tokens.find("unk_token"); !mpnet && found != config.tokens.end())
    o.unknown = found->second;
  for (const auto& [key, token] : config.tokens) {
    if (std::find(o.special.begin(), o.special.end(), token) == o.special.end()) o.special.push_back(token);
  }
  o.longest = limits.longest.value_or(o.longest);
  o.truncate = limits.truncate.value_or(o.truncate);
  return BertTokenizer(std::move(vocabulary), std::move(o), folder + "/vocab.txt");
}

/// vocab.json and merges.txt of RoBERTa, if the vocabulary has its marks, else of CLIP.
inline AnyTokenizer byte_pairs_from_folder(const std::string& folder, const TokenizerLimits& limits) {
  auto pieces = read_vocabulary_json(folder + "/vocab.json");
  const auto merges = read_merges(folder + "/merges.txt");
  if (std::find(pieces.begin(), pieces.end(), "<s>") != pieces.end()) {
    RobertaTokenizerOptions o;
    o.longest = limits.longest.value_or(o.longest);
    o.truncate = limits.truncate.value_or(o.truncate);
    return RobertaTokenizer(std::move(pieces), merges, std::move(o), folder);
  }
  ClipTokenizerOptions o;
  o.cleaning = limits.cleaning;
  o.longest = limits.longest.value_or(o.longest);
  o.truncate = limits.truncate.value_or(o.truncate);
  return ClipTokenizer(std::move(pieces), merges, std::move(o), folder);
}

}  // namespace detail

MOTIONLANG_BODY AnyTokenizer read_tokenizer(const FilePath& folder, const TokenizerLimits& limits) {
  const std::string& name = folder.string();
  if (detail::file_exists(name + "/tokenizer.json")) return read_tokenizer_json(name + "/tokenizer.json", limits);
  TokenizerConfig config;
  if (const std::string file = name + "/tokenizer_config.json"; detail::file_exists(file)) {
    const auto document = read_json(file);
    config = tokenizer_config_from_json(JsonView(document, file));
  }
  if (detail::file_exists(name + "/vocab.txt")) return detail::bert_from_folder(name, config, limits);
  if (detail::file_exists(name + "/vocab.json")) return detail::byte_pairs_from_folder(name, limits);
  raise<io_error>(401, name, ": neither tokenizer.json nor vocab.txt nor vocab.json");
}

MOTIONLANG_NAMESPACE_END
