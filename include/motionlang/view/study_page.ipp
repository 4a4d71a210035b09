// SPDX-License-Identifier: MIT
// Bodies of study_page.hpp.
#pragma once

#include <cstdio>  // fingerprint
#include <map>     // motions

#include <motionlang/view/detail/page_parts.hpp>
#include <motionlang/view/detail/study_page_source.hpp>
#include <motionlang/view/detail/viewer_page.hpp>
#include <motionlang/view/study_page.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The motions of a page, each once, without their names.
class StudyMotions {
 public:
  explicit StudyMotions(const StudyFiles& files) : files_(files) {}
  std::size_t number(const std::string& file) {
    const auto [place, is_new] = numbers_.try_emplace(file, numbers_.size());
    if (is_new) {
      Motion motion = files_.motion(file);
      motion.name.clear();
      shared_.add("study", motion, {}, "");
    }
    return place->second;
  }
  void put_into(nlohmann::ordered_json& page) && { std::move(shared_).put_into(page); }

 private:
  const StudyFiles& files_;
  std::map<std::string, std::size_t> numbers_;
  SharedMotions shared_;
};

inline nlohmann::ordered_json study_tracks(const StudyFiles& files, const std::string& file) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  if (file.empty() || !files.timeline) return out;
  const auto tracks = files.timeline(file);
  require_finite_times("study", tracks);
  for (const Track& t : tracks)
    out.push_back({{"text", t.text}, {"start", t.start}, {"end", t.end}, {"parts", t.parts}});
  return out;
}

inline std::string study_instructions(const Study& study) {
  if (study.kind == StudyKind::rating)
    return "You will see one motion at a time. Choose how much you agree with the statement.";
  if (study.kind == StudyKind::ranking)
    return "Click the answers in the order of your preference, the best one first. A second click takes a choice back.";
  return "You will see two motions beside each other. Choose the better one. Drag a figure to see it from another "
         "side.";
}

}  // namespace detail

MOTIONLANG_BODY std::string study_question(const Study& study, bool show_text) {
  if (study.kind == StudyKind::rating)
    return show_text ? "The body motion correctly represents the text." : "The motion is realistic.";
  if (study.ranks_texts)
    return study.kind == StudyKind::ranking ? "Which texts describe the motion best?"
                                            : "Which text describes the motion better?";
  if (study.kind == StudyKind::ranking)
    return show_text ? "Which motions correspond best to the text?" : "Which motions are the most realistic?";
  return show_text ? "Which motion corresponds better to the text?" : "Which motion is more realistic?";
}

MOTIONLANG_BODY std::string study_html(const Study& study, const StudyFiles& files, const StudyPageOptions& options) {
  using json = nlohmann::ordered_json;
  detail::StudyMotions motions(files);
  json trials = json::array();
  for (const StudyTrial& trial : study_trials(study, options.seed)) {
    const StudyItem& item = study.items[trial.item];
    json one{{"text", options.show_text ? item.text : ""},
             {"tracks", options.show_text ? detail::study_tracks(files, item.timeline) : json::array()}};
    json shown = json::array(), texts = json::array();
    if (study.ranks_texts) shown.push_back(motions.number(item.motion));
    for (const int system : trial.shown) {
      const std::string& choice = item.choices[static_cast<std::size_t>(system)];
      if (study.ranks_texts)
        texts.push_back(choice);
      else
        shown.push_back(motions.number(choice));
    }
    one["motions"] = std::move(shown);
    one["texts"] = std::move(texts);
    trials.push_back(std::move(one));
  }
  char fingerprint[20];
  std::snprintf(fingerprint, sizeof fingerprint, "%016llx", static_cast<unsigned long long>(study.fingerprint));
  json page{{"title", options.title},
            {"question", options.question.empty() ? study_question(study, options.show_text) : options.question},
            {"instructions", options.instructions.empty() ? detail::study_instructions(study) : options.instructions},
            {"kind", to_string(study.kind)},
            {"study", fingerprint},
            {"seed", std::to_string(options.seed)},  // a number of JavaScript has 53 bits only
            {"none", options.no_preference && study.kind == StudyKind::pairs},
            {"trials", std::move(trials)}};
  std::move(motions).put_into(page);
  return detail::self_contained_page(
      options.title, concat_text(detail::page_colours, detail::study_style), detail::study_body, page,
      {detail::viewer_script_pose, detail::viewer_script_draw, detail::viewer_script_shared, detail::study_script});
}

MOTIONLANG_NAMESPACE_END
