// SPDX-License-Identifier: MIT
/// BABEL: texts for whole sequences of AMASS and for stretches of them. Read entry by entry; the stretches as TEACH and
/// SINC take them; and all texts as an entry of the annotation JSON of TMR and STMC.
///
///     const auto file = BabelFile::open("train.json");
///     for (const std::string& id : file.ids()) {
///       const BabelSequence sequence = file.load(id);
///       for (const auto& a : sequence.frame_annotations) use(babel_segments(a.labels, 30, frames, spelling));
///     }
///
/// Source  Punnakkal et al. (CVPR 2021), babel v1.0; TEACH and SINC, extract_frame_labels; spec exchange-formats.md 5.1
///         and 5.4, teach.md 4, sinc.md 5, tmr.md 8.1
#pragma once

#include <algorithm>      // stable_sort
#include <cmath>          // isfinite
#include <unordered_map>  // spelling
#include <utility>        // exchange

#include <motionlang/compose/timeline.hpp>
#include <motionlang/datasets/annotations.hpp>
#include <motionlang/datasets/babel_segment.hpp>
#include <motionlang/datasets/detail/annotated_times.hpp>
#include <motionlang/file/json_members.hpp>
#include <motionlang/text/unicode.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct BabelLabel {
  std::string raw_label, proc_label, seg_id;
  std::vector<std::string> act_cat;  // empty where the file has null
  double start = 0, end = 0;         // seconds; of a whole sequence: all of it
  bool operator==(const BabelLabel&) const = default;
};

/// By one annotator. Labels stand in the order of the file: not sorted, perhaps overlapping, the last one perhaps a few
/// milliseconds longer than the sequence.
struct BabelAnnotation {
  std::string babel_lid, anntr_id;
  bool mul_act = false;  // several actions
  std::vector<BabelLabel> labels;
  bool operator==(const BabelAnnotation&) const = default;
};

struct BabelSequence {
  std::string id;
  std::int64_t babel_sid = 0;
  std::string url, feat_p;  // feat_p: "CMU/CMU/141/141_05_poses.npz", the folder of the data set twice
  double dur = 0;           // seconds, rounded to hundredths; 0 if the file has none
  std::vector<BabelAnnotation> sequence_annotations, frame_annotations;
  bool operator==(const BabelSequence&) const = default;
};

/// A file that is being read: train, val, test (no labels), extra_train, extra_val (several annotations for a
/// sequence).
class BabelFile {
 public:
  /// What is open already.
  explicit BabelFile(JsonMembers members) : members_(std::move(members)) {}
  /// Throws io_error 401, 403 (JsonMembers).
  static BabelFile open(const FilePath& path) { return BabelFile(JsonMembers::open(path)); }
  static BabelFile from_text(std::string text, std::string name = "BABEL") {
    return BabelFile(JsonMembers::from_text(std::move(text), std::move(name)));
  }

  /// In the order of the file.
  const std::vector<std::string>& ids() const { return members_.keys(); }
  bool has(const std::string& id) const { return members_.has(id); }

  /// Throws config_error 103 for an unknown id, 107 for a value of the wrong kind (with its path), io_error 403 for
  /// malformed JSON (with line and column) and for times that are none.
  BabelSequence load(const std::string& id) const {
    const nlohmann::json document = members_.load(id);
    return parse(id, JsonView(document, members_.place(id)));
  }
  /// Whether an entry is one of BABEL, and not one of the annotation JSON.
  static bool is_entry(const JsonView& view) { return view.contains("babel_sid"); }
  /// The sequence of an entry. Throws what load throws for its values.
  static BabelSequence parse(const std::string& id, const JsonView& view) {
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

 private:
  struct Times {
    double start, end;
    bool in_file;
  };

  /// An annotation, a list of them, null or nothing.
  static void read(const JsonView& entry, const std::string& key, const Times& times,
                   std::vector<BabelAnnotation>& out) {
    if (!entry.contains(key) || entry[key].is_null()) return;
    const JsonView view = entry[key];
    if (!view.is_array()) return out.push_back(annotation(view, times));
    for (Index i = 0; i < view.size(); ++i) {
      if (!view[i].is_null()) out.push_back(annotation(view[i], times));
    }
  }
  static BabelAnnotation annotation(const JsonView& view, const Times& times) {
    BabelAnnotation out{
        view.value_or("babel_lid", ""), view.value_or("anntr_id", ""), view.value_or("mul_act", false), {}};
    const JsonView labels = view["labels"];
    for (Index i = 0; i < labels.size(); ++i) out.labels.push_back(label(labels[i], times));
    return out;
  }
  static BabelLabel label(const JsonView& view, const Times& times) {
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

  JsonMembers members_;
};

/// What a word of a label is replaced by: "foward" by "forward", or by several words, or by none.
using SpellingTable = std::unordered_map<std::string, std::string>;

/// The label word by word through the table, joined by single blanks, which also surround words that are replaced by
/// nothing. The published table is the user's to supply.
inline std::string clean_babel_label(std::string_view label, const SpellingTable& spelling = {}) {
  std::string out;
  const char* blank = "";
  for_each_word(label, [&](std::string_view word) {
    const auto found = spelling.find(std::string(word));
    out += std::exchange(blank, " ");
    out += found == spelling.end() ? word : found->second;
  });
  return out;
}

/// The stretches of an annotation in a motion of `frames` frames, in the order of the file and nothing left out:
/// int(start fps) up to int(end fps), cut at the end of the motion, perhaps empty. Throws config_error 101 for a rate
/// that is none.
inline std::vector<BabelSegment> babel_intervals(std::span<const BabelLabel> labels, double fps, Index frames,
                                                 const SpellingTable& spelling = {}) {
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

struct BabelSegmentOptions {
  bool keep_transitions = false;  // TEACH pairs actions by the transition between them
};

/// Those to train on, sorted by start and end: without empty ones, those without text and excluded labels. Throws
/// config_error 101 for a rate that is none.
inline std::vector<BabelSegment> babel_segments(std::span<const BabelLabel> labels, double fps, Index frames,
                                                const SpellingTable& spelling = {},
                                                const BabelSegmentOptions& options = {}) {
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

/// The texts of a sequence as an entry of the annotation JSON: those of the whole sequence, then those of stretches, in
/// the order of the file. The id has five digits or more, the path is that of AMASS: without the first of the two
/// folders and without extension. Labels without a word are left out, no others.
/// Throws  io_error 403 for a sequence without feat_p or dur
inline AnnotatedMotion annotated_motion(const BabelSequence& sequence, const SpellingTable& spelling = {}) {
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
