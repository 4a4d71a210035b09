// SPDX-License-Identifier: MIT
/// BABEL: texts for whole sequences of AMASS and for segments of them. It is read entry by entry. TEACH and SINC get
/// the segments. All texts can also become an entry of the annotation JSON of TMR and STMC.
///
///     const auto file = BabelFile::open("train.json");
///     for (const std::string& id : file.ids()) {
///       const BabelSequence sequence = file.load(id);
///       for (const auto& a : sequence.frame_annotations) use(babel_segments(a.labels, 30, frames, spelling));
///     }
///
/// Source  Punnakkal et al. (CVPR 2021), babel v1.0; TEACH teach/data/babel.py and SINC
///         sinc/data/tools/extract_pairs.py, extract_frame_labels
#pragma once

#include <cstdint>        // numbers of sequences
#include <span>           // labels
#include <string>         // labels
#include <string_view>    // labels
#include <unordered_map>  // spelling
#include <utility>        // move
#include <vector>         // annotations

#include <motionlang/datasets/annotations.hpp>
#include <motionlang/datasets/babel_segment.hpp>
#include <motionlang/file/json_members.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct BabelLabel {
  std::string raw_label, proc_label, seg_id;
  std::vector<std::string> act_cat;  // empty where the file has null
  double start = 0, end = 0;         // seconds; of a whole sequence: all of it
  bool operator==(const BabelLabel&) const = default;
};

/// Labels by one annotator, in the order of the file. They are not sorted and may overlap, and the last one may be a
/// few milliseconds longer than the sequence.
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

/// A file that is open for reading: train, val, test (no labels), or extra_train, extra_val (several annotations for a
/// sequence).
class BabelFile {
 public:
  /// From a file that is already open.
  explicit BabelFile(JsonMembers members) : members_(std::move(members)) {}
  /// Throws io_error 401, 403 (JsonMembers).
  static BabelFile open(const FilePath& path);
  static BabelFile from_text(std::string text, std::string name = "BABEL");

  /// In the order of the file.
  const std::vector<std::string>& ids() const { return members_.keys(); }
  bool has(const std::string& id) const { return members_.has(id); }

  /// Throws config_error 103 for an unknown id, 107 for a value of the wrong kind (with its path), io_error 403 for
  /// malformed JSON (with line and column) and for times that are not valid.
  BabelSequence load(const std::string& id) const;
  /// True if an entry is one of BABEL, and not one of the annotation JSON.
  static bool is_entry(const JsonView& view);
  /// The sequence of an entry. Throws what load throws for its values.
  static BabelSequence parse(const std::string& id, const JsonView& view);

 private:
  struct Times {
    double start, end;
    bool in_file;
  };

  /// An annotation, a list of them, null or nothing.
  static void read(const JsonView& entry, const std::string& key, const Times& times,
                   std::vector<BabelAnnotation>& out);
  static BabelAnnotation annotation(const JsonView& view, const Times& times);
  static BabelLabel label(const JsonView& view, const Times& times);

  JsonMembers members_;
};

/// The replacement for a word of a label. "foward" becomes "forward", several words, or none.
using SpellingTable = std::unordered_map<std::string, std::string>;

/// Replaces the words of a label by the table and joins them by single blanks. A word that is replaced by nothing
/// leaves both of its blanks. The published table is not part of this library.
std::string clean_babel_label(std::string_view label, const SpellingTable& spelling = {});

/// The segments of an annotation in a motion of `frames` frames, in the order of the file, with nothing left out. Each
/// goes from int(start fps) up to int(end fps), is cut at the end of the motion, and may be empty. Throws config_error
/// 101 unless the rate is positive and finite.
std::vector<BabelSegment> babel_intervals(std::span<const BabelLabel> labels, double fps, Index frames,
                                          const SpellingTable& spelling = {});

struct BabelSegmentOptions {
  bool keep_transitions = false;  // TEACH pairs actions by the transition between them
};

/// The segments for training, sorted by start and end. Empty ones, those without a text and those with excluded labels
/// are left out. Throws config_error 101 unless the rate is positive and finite.
std::vector<BabelSegment> babel_segments(std::span<const BabelLabel> labels, double fps, Index frames,
                                         const SpellingTable& spelling = {}, const BabelSegmentOptions& options = {});

/// The texts of a sequence as an entry of the annotation JSON: those of the whole sequence, then those of segments, in
/// the order of the file. The id has five digits or more. The path is that of AMASS: without the first of the two
/// folders and without extension. Only labels without a word are left out.
/// Throws  io_error 403 for a sequence without feat_p or dur
AnnotatedMotion annotated_motion(const BabelSequence& sequence, const SpellingTable& spelling = {});

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/babel.ipp>
#endif
