// SPDX-License-Identifier: MIT
// Bodies of known_captions.hpp.
#pragma once

#include <algorithm>  // any_of, find, lower_bound, sort
#include <map>        // rows
#include <utility>    // pair

#include <motionlang/text/known_captions.hpp>
#include <motionlang/text/mirror_caption.hpp>
#include <motionlang/text/word_piece.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// "do not" for "don't".
inline std::string without_contractions(std::string text) {
  constexpr std::pair<std::string_view, std::string_view> contractions[] = {
      {"won't", "will not"}, {"can't", "can not"}, {"n't", " not"}};
  for (const auto& [contraction, words] : contractions) {
    for (std::size_t at = 0; (at = text.find(contraction, at)) != text.npos;)
      text.replace(at, contraction.size(), words);
  }
  return text;
}

/// A verb, and what it may be a form of: "kicks" and "kicking" of "kick", "hopping" of "hop", "dancing" of "dance".
inline std::vector<std::string> plain_forms(const std::string& verb) {
  std::vector<std::string> out{verb};
  for (const std::string_view ending : {"s", "es", "ing"}) {
    if (!verb.ends_with(ending) || verb.size() < ending.size() + 2) continue;
    const std::string stem = verb.substr(0, verb.size() - ending.size());
    out.push_back(stem);
    if (ending != "ing") continue;
    out.push_back(stem + "e");
    if (stem[stem.size() - 1] == stem[stem.size() - 2]) out.push_back(stem.substr(0, stem.size() - 1));
  }
  return out;
}

}  // namespace detail

MOTIONLANG_BODY KnownCaptions::KnownCaptions(TextTable table, std::vector<KnownAction> actions, double nearness,
                                             std::vector<double> done, std::string_view source)
    : table_(std::move(table)), actions_(std::move(actions)), nearness_(nearness), done_(std::move(done)) {
  if (std::ssize(actions_) + std::ssize(done_) != table_.size())
    raise<shape_error>(205, source, ": ", counted(actions_.size(), "action"), " and ", counted(done_.size(), "share"),
                       " for ", counted(table_.size(), "text"));
}

MOTIONLANG_BODY KnownCaptions KnownCaptions::with_tried(const std::vector<std::string>& texts,
                                                        std::vector<double> done) const {
  if (empty()) return {};
  return {table_.first(std::ssize(actions_)).with(texts), actions_, nearness_, std::move(done)};
}

MOTIONLANG_BODY KnownCaptions KnownCaptions::with_captions(const std::vector<std::string>& texts,
                                                           const std::vector<KnownAction>& actions) const {
  if (texts.size() != actions.size())
    raise<shape_error>(205, "KnownCaptions: ", counted(actions.size(), "action"), " for ",
                       counted(texts.size(), "text"));
  if (empty()) return {};
  const auto old = table_.texts().begin(), tried = old + std::ssize(actions_);
  std::vector<std::string> all(old, tried);
  std::vector<KnownAction> of_all = actions_;
  std::map<std::string, std::size_t> row;
  for (std::size_t i = 0; i < all.size(); ++i) row.emplace(all[i], i);
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const auto [at, is_new] = row.emplace(texts[i], all.size());
    if (is_new) all.push_back(texts[i]), of_all.emplace_back();
    of_all[at->second] = actions[i];
  }
  const std::vector<std::string> tried_texts(tried, table_.texts().end());
  return {table_.encoded_again(std::move(all)).with(tried_texts), std::move(of_all), nearness_, done_};
}

MOTIONLANG_BODY std::vector<KnownCaptions::Found> KnownCaptions::found(const std::string& text, Index count,
                                                                       Index first, Index last) const {
  std::vector<std::string> texts{text};
  if (std::string mirrored = mirror_caption(text); mirrored != text) texts.push_back(std::move(mirrored));
  const auto near = table_.nearest(texts, count, [&](Index, Index row) { return row >= first && row < last; });
  std::vector<Found> all;
  for (std::size_t t = 0; t < near.size(); ++t) {
    for (NearText n : near[t]) {
      if (t == 1) n.text = mirror_caption(n.text);
      all.push_back({std::move(n), t == 1});
    }
  }
  std::stable_sort(all.begin(), all.end(),
                   [](const Found& a, const Found& b) { return a.near.likeness > b.near.likeness; });
  // A caption itself is before its equals, which rounding may have put first: "look left", the image of "look right".
  std::stable_partition(all.begin(), all.end(), [&](const Found& f) { return !f.mirrored && f.near.text == text; });
  return all;
}

MOTIONLANG_BODY std::vector<KnownCaptions::Found> KnownCaptions::different(std::vector<Found> all, Index count) {
  std::vector<Found> out;
  for (Found& f : all) {
    const bool again = std::any_of(out.begin(), out.end(), [&](const Found& o) { return o.near.text == f.near.text; });
    if (!again && std::ssize(out) < count) out.push_back(std::move(f));
  }
  return out;
}

MOTIONLANG_BODY std::vector<NearText> KnownCaptions::nearest(const std::string& text, Index count) const {
  return nearest_of_plain(plain(text), count);
}

MOTIONLANG_BODY std::vector<NearText> KnownCaptions::nearest_of_plain(const std::string& plain, Index count) const {
  std::vector<NearText> out;
  auto all = found(plain, count, 0, std::ssize(actions_));
  for (Found& f : different(std::move(all), count)) out.push_back(std::move(f.near));
  return out;
}

MOTIONLANG_BODY std::vector<MisspelledWord> KnownCaptions::misspelled(const std::string& text) const {
  std::vector<MisspelledWord> out;
  for (const std::string& word : WordPiece::words(detail::without_contractions(text))) {
    if (std::string read = table_.mended(word); !read.empty()) out.push_back({word, std::move(read)});
  }
  return out;
}

MOTIONLANG_BODY std::string KnownCaptions::plain(const std::string& text) const {
  std::string out = detail::without_contractions(text);
  const auto mistakes = misspelled(out);
  if (mistakes.empty()) return out;
  std::vector<std::string> words = WordPiece::words(out);
  for (const MisspelledWord& m : mistakes) std::replace(words.begin(), words.end(), m.word, m.read);
  return join_text(words, " ");
}

MOTIONLANG_BODY std::string KnownCaptions::known_beginning(const std::string& text) const {
  constexpr double near = 0.7, half_near = 0.5, same = 0.9;
  std::string plain = this->plain(text);
  const auto best = nearest_of_plain(plain, 1);
  if (best.empty() || best.front().likeness >= near) return plain;
  std::vector<std::string> words = WordPiece::words(plain);
  const auto says = [](const std::string& word) { return !detail::is_function_word(word); };
  words.erase(words.begin(), std::find_if(words.begin(), words.end(), says));
  const auto all = std::count_if(words.begin(), words.end(), says);
  // A text that is not so far means its beginning only if that is half of it.
  const auto least = best.front().likeness < half_near ? 1 : std::max<std::ptrdiff_t>(1, all / 2);
  std::vector<std::string> beginnings;  // the longest first, each before its mirror image
  for (; std::count_if(words.begin(), words.end(), says) >= least; words.pop_back()) {
    if (!says(words.back())) continue;
    std::string beginning;
    for (const std::string& word : words) beginning += (beginning.empty() ? "" : " ") + word;
    beginnings.push_back(beginning);
    beginnings.push_back(mirror_caption(beginning));
  }
  const auto& captions = table_.texts();
  const auto tried = captions.begin() + std::ssize(actions_);
  const auto has = [&](const std::string& caption) { return std::find(captions.begin(), tried, caption) != tried; };
  const auto near_beginnings =
      table_.nearest(beginnings, 1, [&](Index, Index row) { return row < std::ssize(actions_); });
  for (std::size_t i = 0; i < beginnings.size(); ++i) {
    const std::size_t end = std::min(beginnings[i].find(' '), beginnings[i].size());  // of its first word
    for (std::string form : detail::plain_forms(beginnings[i].substr(0, end))) {
      form += beginnings[i].substr(end);
      if (has(form)) return i % 2 == 0 ? form : mirror_caption(form);
    }
    const NearText& alike = near_beginnings[i].front();
    if (alike.likeness * alike.said >= same) return i % 2 == 0 ? alike.text : mirror_caption(alike.text);
  }
  return plain;
}

MOTIONLANG_BODY std::vector<NearCaption> KnownCaptions::meant(const std::string& text, Index count) const {
  constexpr double same = 0.95, nearly_same = 0.96, nearly_as_alike = 0.88;
  // A caption that says more than the text is less alike: "walk and get pushed" for "walk".
  const auto rank = [](const Found& f) { return f.near.likeness * (2 + f.near.said) / 3; };
  constexpr Index looked_at = 24;
  auto all = found(known_beginning(text), std::max(count, looked_at), 0, std::ssize(actions_));
  std::erase_if(all, [&](const Found& f) { return f.near.likeness < nearness_; });
  std::stable_sort(all.begin(), all.end(), [&](const Found& a, const Found& b) { return rank(a) > rank(b); });
  std::vector<NearCaption> out;
  for (const Found& f : all) {
    // A text that is a caption means no other action: "walk forward" is not "walk forward quickly".
    const double least = (rank(all.front()) < same ? nearly_as_alike : nearly_same) * rank(all.front());
    if (rank(f) < least || std::ssize(out) == count) break;
    out.push_back({f.near.row, f.mirrored, f.near.likeness});
  }
  return out;
}

MOTIONLANG_BODY std::vector<std::string> KnownCaptions::meant_texts(const std::string& text, Index count) const {
  std::vector<std::string> out;
  for (const NearCaption& near : meant(text, count)) {
    const std::string& caption = table_.texts()[static_cast<std::size_t>(near.row)];
    out.push_back(near.mirrored ? mirror_caption(caption) : caption);
  }
  return out;
}

MOTIONLANG_BODY bool KnownCaptions::knows(const std::string& text) const {
  const auto first = nearest(text, 1);
  return !first.empty() && first.front().likeness >= nearness_;
}

MOTIONLANG_BODY std::optional<KnownAction> KnownCaptions::action(const std::string& text) const {
  const std::string known = known_beginning(text);
  constexpr Index asked = 12;
  constexpr double as_near = 0.9, exact = 3;  // a share of the best likeness; the weight of the caption itself
  const auto found = different(this->found(known, asked, 0, std::ssize(actions_)), asked);
  if (found.empty() || found.front().near.likeness < nearness_) return std::nullopt;
  double repeats = 0, all = 0;
  const auto weight = [&](const Found& f) {
    if (f.near.likeness < as_near * found.front().near.likeness) return 0.0;
    return f.near.text == known ? exact * f.near.likeness : f.near.likeness;
  };
  const auto action_of = [&](const Found& f) { return actions_[static_cast<std::size_t>(f.near.row)]; };
  for (const Found& f : found) {
    all += weight(f);
    if (action_of(f).repeats) repeats += weight(f);
  }
  KnownAction out{.repeats = 2 * repeats > all};
  std::vector<std::pair<double, double>> lengths;  // seconds, weight
  for (const Found& f : found) {
    const KnownAction action = action_of(f);
    if (weight(f) == 0 || action.repeats != out.repeats) continue;
    if (lengths.empty()) out.then = f.mirrored ? mirror_caption(action.then) : action.then;
    lengths.emplace_back(action.seconds, weight(f));
  }
  std::sort(lengths.begin(), lengths.end());
  const double three_quarters = 0.75 * (out.repeats ? repeats : all - repeats);
  double until = 0;
  for (const auto& [seconds, w] : lengths) {
    out.seconds = seconds;
    if (until += w; until >= three_quarters) break;
  }
  return out;
}

MOTIONLANG_BODY std::optional<double> KnownCaptions::success(const std::string& text) const {
  constexpr Index asked = 3;
  constexpr double nearly_same = 0.8;
  double done = 0, weights = 0;
  for (const Found& f : different(found(text, asked, std::ssize(actions_), table_.size()), asked)) {
    if (f.near.likeness < nearly_same) continue;
    done += f.near.likeness * done_[static_cast<std::size_t>(f.near.row) - actions_.size()];
    weights += f.near.likeness;
    if (f.near.text == text) break;  // the text itself, which is the nearest
  }
  if (weights == 0) return std::nullopt;
  return done / weights;
}

MOTIONLANG_BODY double dividing_likeness(std::vector<double> related, std::vector<double> unrelated) {
  if (related.empty() || unrelated.empty()) return 0;
  std::sort(related.begin(), related.end());
  std::sort(unrelated.begin(), unrelated.end());
  const auto below = [](const std::vector<double>& values, double x) {
    const auto count = std::lower_bound(values.begin(), values.end(), x) - values.begin();
    return static_cast<double>(count) / static_cast<double>(values.size());
  };
  double best = -2, out = 0;
  for (const double r : related) {  // the smallest related value that is still counted in
    const double right = below(unrelated, r) - below(related, r);
    if (right <= best) continue;
    best = right;
    const auto next = std::lower_bound(unrelated.begin(), unrelated.end(), r);
    out = next == unrelated.begin() ? r : (r + *(next - 1)) / 2;
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
