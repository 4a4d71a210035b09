// SPDX-License-Identifier: MIT
// Bodies of the headers in datasets/ that need nlohmann/json.hpp, compiled once for motionlang::instantiated.
#include <motionlang/datasets/actor_clips.ipp>
#include <motionlang/datasets/annotated_texts.ipp>
#include <motionlang/datasets/annotations.ipp>
#include <motionlang/datasets/babel.ipp>
#include <motionlang/datasets/babel_motions.ipp>
#include <motionlang/datasets/body_part_lines.ipp>
#include <motionlang/datasets/body_part_table.ipp>
#include <motionlang/datasets/caption_card.ipp>
#include <motionlang/datasets/clip_lines.ipp>
#include <motionlang/datasets/described_motions.ipp>
#include <motionlang/datasets/kit_recordings.ipp>
#include <motionlang/datasets/label_sentences.ipp>
#include <motionlang/datasets/label_tags.ipp>
#include <motionlang/datasets/mtt_motions.ipp>
#include <motionlang/datasets/segment_motion.ipp>
#include <motionlang/datasets/word_counts.ipp>
