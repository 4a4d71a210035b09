// SPDX-License-Identifier: MIT
// Bodies of gallery_prompts.hpp.
#pragma once

#include <algorithm>  // clamp, sort
#include <cmath>      // isinf, round
#include <map>        // verbs
#include <set>        // words
#include <tuple>      // order

#include <motionlang/compose/text_timeline.hpp>
#include <motionlang/compose/timeline_text.hpp>
#include <motionlang/core/quantile.hpp>
#include <motionlang/core/utf8.hpp>
#include <motionlang/datasets/caption_card.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/generate/gallery_prompts.hpp>
#include <motionlang/metrics/rows.hpp>
#include <motionlang/text/known_words.hpp>
#include <motionlang/view/contact_sheet.hpp>
#include <motionlang/view/gallery_page.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// True for a first word that says nothing about the movement.
inline bool is_empty_verb(std::string_view word) {
  return word.empty() || word.ends_with("ly") || word == "be" || word == "do" || word == "have";
}

/// The segments that show a verb.
struct ShownVerb {
  std::map<std::string, std::size_t> captions{};  // and how many segments have each
  std::vector<double> seconds{};                  // of each segment

  const std::string& caption() const {
    const auto rank = [](const auto& c) {
      return std::tuple(-static_cast<std::ptrdiff_t>(c.second), caption_words(c.first).size());
    };
    return std::min_element(captions.begin(), captions.end(),
                            [&](const auto& a, const auto& b) { return rank(a) < rank(b); })
        ->first;
  }
  double length() const { return std::clamp(std::round(2 * quantile(seconds, 0.5)) / 2, 2.0, 5.0); }
};

/// The first word, in lower case.
inline std::string first_word(std::string_view text) {
  const auto words = caption_words(text);
  return words.empty() ? std::string(text) : words.front();
}

/// The timeline that `motionlang generate` makes of a text.
inline Timeline gallery_timeline(const GalleryPrompt& p, const MotionModel& model, const GenerateOptions& options) {
  if (!model.takes_timelines())
    return whole_body_timeline(p.text, frame_at(p.seconds > 0 ? p.seconds : text_seconds, model.fps()));
  TextTimelineOptions how{.seconds = {}, .fps = model.fps(), .end_actions = ends_actions(options)};
  if (p.seconds > 0) how.seconds = p.seconds;
  return text_timeline(p.text, model.captions(), how);
}

}  // namespace detail

MOTIONLANG_BODY std::vector<GalleryPrompt> gallery_prompts(std::span<const ClipLine> captions, std::size_t least) {
  std::map<std::string, detail::ShownVerb> verbs;
  for (const ClipLine& line : captions) {
    std::set<std::string> shown;
    for (const std::string& text : line.texts) {
      const std::string verb = commanded_verb(text);
      if (detail::is_empty_verb(verb)) continue;
      ++verbs[verb].captions[text];
      if (shown.insert(verb).second) verbs[verb].seconds.push_back(std::isinf(line.end) ? 4 : line.end - line.start);
    }
  }
  std::vector<std::pair<std::string, const detail::ShownVerb*>> order;
  for (const auto& [verb, shown] : verbs) {
    if (shown.seconds.size() >= least) order.emplace_back(verb, &shown);
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.second->seconds.size() > b.second->seconds.size(); });
  std::vector<GalleryPrompt> out;
  out.reserve(order.size());
  for (const auto& [verb, shown] : order) out.push_back({verb, shown->caption(), shown->length()});
  return out;
}

MOTIONLANG_BODY std::vector<GalleryPrompt> gallery_prompts(const KnownCaptions& captions, std::size_t least) {
  std::map<std::string, std::vector<std::string>> verbs;
  if (captions.empty()) return {};
  const auto& texts = captions.table().texts();
  for (std::size_t i = 0; i < captions.actions().size(); ++i) {  // texts that were tried follow
    const std::string verb = commanded_verb(texts[i]);
    if (!detail::is_empty_verb(verb)) verbs[verb].push_back(texts[i]);
  }
  std::vector<std::pair<std::string, const std::vector<std::string>*>> order;
  for (const auto& [verb, list] : verbs) {
    if (list.size() >= least) order.emplace_back(verb, &list);
  }
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.second->size() > b.second->size(); });
  std::vector<GalleryPrompt> out;
  for (const auto& [verb, list] : order) {
    const auto rank = [](const std::string& text) { return std::pair(detail::caption_words(text).size(), text); };
    out.push_back({verb, *std::min_element(list->begin(), list->end(),
                                           [&](const auto& a, const auto& b) { return rank(a) < rank(b); })});
  }
  return out;
}

MOTIONLANG_BODY std::vector<GalleryPrompt> parse_gallery_prompts(std::string_view text, std::string_view name) {
  constexpr double finer = 100'000, kept = 1000;  // frames are cut off, milliseconds are rounded
  std::vector<GalleryPrompt> out;
  for (const TimedText& t : parse_text_list(text, {.fps = finer, .name = name})) {
    const double seconds = std::round(static_cast<double>(t.frames) / finer * kept) / kept;
    out.push_back({detail::first_word(t.text), t.text, seconds});
  }
  return out;
}

MOTIONLANG_BODY std::string write_gallery_prompts(std::span<const GalleryPrompt> prompts) {
  std::string out;
  for (const GalleryPrompt& p : prompts) {
    if (p.text.find_first_of("#\r\n") != p.text.npos)
      raise<config_error>(101, "write_gallery_prompts: the text '", printable(p.text), "' contains '#' or a line end");
    out += concat_text(p.text, " # ", p.seconds > 0 ? p.seconds : 4, "\n");
  }
  return out;
}

MOTIONLANG_BODY std::vector<GalleryPrompt> take_unknown_prompts(std::vector<GalleryPrompt>& prompts,
                                                                const MotionModel& model) {
  std::vector<GalleryPrompt> out;
  std::erase_if(prompts, [&](const GalleryPrompt& p) {
    const bool far = !model.captions().empty() && !model.captions().knows(p.text);
    const bool unknown = far || !unknown_words(p.text, model.words()).empty();
    if (unknown) out.push_back(p);
    return unknown;
  });
  return out;
}

MOTIONLANG_BODY std::vector<Motion> gallery_motions(const MotionModel& model, std::span<const GalleryPrompt> prompts,
                                                    const GenerateOptions& options) {
  std::vector<Motion> out;
  GenerateOptions how = options;
  how.notes = nullptr;
  for (const GalleryPrompt& p : prompts) {
    auto last = [&](Index, Index) { return options.progress(std::ssize(out), std::ssize(prompts)), true; };
    how.progress = last;  // so that a long motion can be stopped
    out.push_back(generate_motion(model, detail::gallery_timeline(p, model, how), how));
    out.back().name = p.text;
    options.progress(std::ssize(out), std::ssize(prompts));
  }
  return out;
}

MOTIONLANG_BODY std::filesystem::path gallery_list_beside(const std::filesystem::path& model) {
  const auto beside = (std::filesystem::is_directory(model) ? model : model.parent_path()) / "gallery.txt";
  return std::filesystem::exists(beside) ? beside : std::filesystem::path();
}

MOTIONLANG_BODY void write_gallery(const std::filesystem::path& folder, std::span<const Motion> motions,
                                   std::span<const GalleryPrompt> prompts, const GalleryFileOptions& options) {
  detail::require_same_count("write_gallery: motions against prompts", std::ssize(motions), std::ssize(prompts));
  std::vector<GalleryCard> cards;
  std::vector<SheetEntry> entries;
  for (std::size_t i = 0; i < motions.size(); ++i) {
    cards.push_back({motions[i], prompts[i].verb, prompts[i].text});
    if (i < options.pictured) entries.push_back({motions[i], prompts[i].text});
  }
  write_file(folder / gallery_page_name, gallery_html(cards, {.title = options.title, .info = options.info}));
  write_file(folder / gallery_picture_name,
             contact_sheet_svg(entries, {.columns = options.columns, .poses = options.poses}));
}

MOTIONLANG_NAMESPACE_END
