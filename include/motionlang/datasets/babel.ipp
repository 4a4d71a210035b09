// SPDX-License-Identifier: MIT
// Bodies of babel.hpp.
#pragma once

#include <algorithm>  // min, stable_sort
#include <cmath>      // isfinite

#include <motionlang/compose/timeline.hpp>
#include <motionlang/datasets/babel.hpp>
#include <motionlang/datasets/detail/annotated_times.hpp>
#include <motionlang/file/json.hpp>
#include <motionlang/text/unicode.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY BabelFile BabelFile::open(const FilePath& path) { return BabelFile(JsonMembers::open(path)); }

MOTIONLANG_BODY BabelFile BabelFile::from_text(std::string text, std::string name) {
  return BabelFile(JsonMembers::from_text(std::move(text), std::move(name)));
}

MOTIONLANG_BODY BabelSequence BabelFile::load(const std::string& id) const {
  const nlohmann::json document = members_.load(id);
  return parse(id, JsonView(document, members_.place(id)));
}

MOTIONLANG_BODY bool BabelFile::is_entry(const JsonView& view) { return view.contains("babel_sid"); }

MOTIONLANG_BODY BabelSequence BabelFile::parse(const std::string& id, const JsonView& view) {
  BabelSequence out{id,
                    view["babel_sid"].as<std::int64_t>(),
                    view.value_or("url", ""),
                    view.value_or("feat_p", ""),
                    view.value_or("dur", 0.0),
                    {},
                    {}};
  if (!(out.dur >= 0 && std::isfinite(out.dur))) raise<io_error>(403, view.path(), ": dur is ", out.dur);
  for (const char* key : {"seq_ann", "seq_anns"}) read(view, key, {0, out.dur, false}, out.sequence_annotations);
  for (const char* key : {"frame_ann", "frame_anns"}) read(view, key, {0, 0, true}, out.frame_annotations);
  return out;
}

MOTIONLANG_BODY void BabelFile::read(const JsonView& entry, const std::string& key, const Times& times,
                                     std::vector<BabelAnnotation>& out) {
  if (!entry.contains(key) || entry[key].is_null()) return;
  const JsonView view = entry[key];
  if (!view.is_array()) return out.push_back(annotation(view, times));
  for (Index i = 0; i < view.size(); ++i) {
    if (!view[i].is_null()) out.push_back(annotation(view[i], times));
  }
}

MOTIONLANG_BODY BabelAnnotation BabelFile::annotation(const JsonView& view, const Times& times) {
  BabelAnnotation out{
      view.value_or("babel_lid", ""), view.value_or("anntr_id", ""), view.value_or("mul_act", false), {}};
  const JsonView labels = view["labels"];
  for (Index i = 0; i < labels.size(); ++i) out.labels.push_back(label(labels[i], times));
  return out;
}

MOTIONLANG_BODY BabelLabel BabelFile::label(const JsonView& view, const Times& times) {
  BabelLabel out{view.value_or("raw_label", ""),
                 view.value_or("proc_label", ""),
                 view.value_or("seg_id", ""),
                 view.value_or("act_cat", std::vector<std::string>{}),
                 times.start,
                 times.end};
  if (times.in_file) {
    out.start = view["start_t"].as<double>();
    out.end = view["end_t"].as<double>();
    detail::require_times(view.path(), out.start, out.end);
  }
  return out;
}

MOTIONLANG_BODY std::string clean_babel_label(std::string_view label, const SpellingTable& spelling) {
  std::string out;
  const char* blank = "";
  for_each_word(label, [&](std::string_view word) {
    const auto found = spelling.find(std::string(word));
    out += std::exchange(blank, " ");
    out += found == spelling.end() ? word : found->second;
  });
  return out;
}

MOTIONLANG_BODY std::vector<BabelSegment> babel_intervals(std::span<const BabelLabel> labels, double fps, Index frames,
                                                          const SpellingTable& spelling) {
  if (!(fps > 0 && std::isfinite(fps))) raise<config_error>(101, "babel_intervals: ", fps, " frames per second");
  const auto frame = [&](double seconds, Index last) {
    return static_cast<Index>(std::min(seconds * fps, static_cast<double>(last)));
  };
  std::vector<BabelSegment> out;
  for (const BabelLabel& label : labels) {
    out.push_back(
        {frame(label.start, latest_time), frame(label.end, frames), clean_babel_label(label.proc_label, spelling)});
  }
  return out;
}

MOTIONLANG_BODY std::vector<BabelSegment> babel_segments(std::span<const BabelLabel> labels, double fps, Index frames,
                                                         const SpellingTable& spelling,
                                                         const BabelSegmentOptions& options) {
  std::vector<BabelSegment> out = babel_intervals(labels, fps, frames, spelling);
  std::erase_if(out, [&](const BabelSegment& s) {
    const bool kept = options.keep_transitions && s.is_transition();
    return s.end <= s.start || s.text.empty() || (is_babel_excluded(s.text) && !kept);
  });
  std::stable_sort(out.begin(), out.end(), [](const BabelSegment& a, const BabelSegment& b) {
    return std::pair(a.start, a.end) < std::pair(b.start, b.end);
  });
  return out;
}

MOTIONLANG_BODY AnnotatedMotion annotated_motion(const BabelSequence& sequence, const SpellingTable& spelling) {
  const std::string& id = sequence.id;
  if (sequence.feat_p.empty() || sequence.dur == 0)
    raise<io_error>(403, "BABEL: ", id, ": ", sequence.feat_p.empty() ? "no feat_p" : "no dur");
  const bool number = id.find_first_not_of("0123456789") == id.npos;
  AnnotatedMotion out{number && id.size() < 5 ? std::string(5 - id.size(), '0') + id : id,
                      sequence.feat_p.substr(sequence.feat_p.find('/') + 1),
                      sequence.dur,
                      {}};
  if (out.path.ends_with(".npz")) out.path.resize(out.path.size() - 4);
  for (const auto* annotations : {&sequence.sequence_annotations, &sequence.frame_annotations}) {
    for (const BabelAnnotation& a : *annotations) {
      for (const BabelLabel& label : a.labels) {
        std::string text = clean_babel_label(label.proc_label, spelling);
        if (text.empty()) continue;
        std::string seg_id = concat_text(out.id, "_", out.annotations.size());
        out.annotations.push_back({std::move(seg_id), std::move(text), label.start, label.end, label.seg_id});
      }
    }
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
