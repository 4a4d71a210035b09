// SPDX-License-Identifier: MIT
// Bodies of learned_captions.hpp.
#pragma once

#include <algorithm>  // any_of, count_if, reverse
#include <limits>     // distances
#include <map>        // captions
#include <set>        // segments
#include <utility>    // pair

#include <motionlang/datasets/caption_card.hpp>
#include <motionlang/datasets/segment_motion.hpp>
#include <motionlang/kinematics/loops.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/text/word_piece.hpp>
#include <motionlang/train/learned_captions.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

using SegmentsOfCaption = std::map<std::string, std::set<std::size_t>>;

inline SegmentsOfCaption segments_of_captions(const std::vector<CaptionedSegment>& segments) {
  SegmentsOfCaption out;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    for (const std::string& caption : sampled_captions(segments[i])) out[caption].insert(i);
  }
  return out;
}

/// True if every joint stays within 8 cm of where it is at first.
inline bool is_still(const Motion& motion) {
  const auto positions = motion.positions();
  const auto joints = static_cast<std::size_t>(motion.skeleton.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (norm(positions[i] - positions[i % joints]) > 0.08) return false;
  }
  return true;
}

/// True if joints move at less than 0.25 m/s on average in the last quarter of a second.
inline bool comes_to_rest(const Motion& motion) {
  const Index last = motion.frames() - 1,
              before = std::max<Index>(0, last - std::max<Index>(1, static_cast<Index>(motion.fps / 4)));
  if (before == last) return false;
  const auto positions = motion.positions();
  const Index joints = motion.skeleton.size();
  double path = 0;
  for (Index f = before; f < last; ++f) {
    for (Index j = 0; j < joints; ++j)
      path += norm(positions[static_cast<std::size_t>((f + 1) * joints + j)] -
                   positions[static_cast<std::size_t>(f * joints + j)]);
  }
  const double seconds = static_cast<double>(last - before) / motion.fps;
  return path / static_cast<double>(joints) / seconds < 0.25;
}

/// True for commands to be in a pose. "nod" and "fire a shot" may be still as well, but begin something.
inline bool commands_pose(const std::string& caption) {
  static const std::set<std::string> verbs{"be",     "crouch", "freeze", "hold",  "keep",  "kneel", "lean", "lie",
                                           "remain", "rest",   "sit",    "squat", "stand", "stay",  "wait"};
  return verbs.contains(commanded_verb(caption));
}

/// A command to be in a pose among the captions: that of the most segments, the shortest among equals. "" if none.
inline std::string commonest_pose(const CaptionedSegment& segment, const SegmentsOfCaption& segments_of) {
  std::string best;
  std::size_t most = 0;
  for (const std::string& c : segment.captions) {
    const std::size_t count = segments_of.at(c).size();
    if (!commands_pose(c) || count < most || (count == most && c.size() >= best.size())) continue;
    best = c, most = count;
  }
  return best;
}

/// A still segment: its first pose, and a text for it.
struct StillPose {
  std::vector<Vec3<double>> pose{};
  std::string text{};
};

inline std::vector<StillPose> still_poses(const std::vector<CaptionedSegment>& segments) {
  const SegmentsOfCaption segments_of = segments_of_captions(segments);
  std::vector<StillPose> out;
  for (const CaptionedSegment& s : segments) {
    if (s.rest || !is_still(s.motion)) continue;  // what something follows is an action: "tilt the head"
    if (std::string text = commonest_pose(s, segments_of); !text.empty())
      out.push_back({poses_in_place(crop(s.motion, 0, 1)), std::move(text)});
  }
  return out;
}

inline std::string text_of_last_pose(const Motion& motion, const std::vector<StillPose>& still) {
  std::string out = "stand still";
  const auto pose = poses_in_place(crop(motion, motion.frames() - 1, motion.frames()));
  double nearest = std::numeric_limits<double>::infinity();
  for (const StillPose& s : still) {
    if (s.pose.size() != pose.size()) continue;
    const double distance = pose_distance(pose.data(), s.pose.data(), std::ssize(pose));
    if (distance < nearest) nearest = distance, out = s.text;
  }
  return out;
}

/// The caption with other words where it says something.
inline std::string with_other_words(const std::string& caption, const WordVectors& words, Philox& rng) {
  std::vector<std::string> out = WordPiece::words(caption);
  for (std::string& word : out) {
    if (is_function_word(word)) continue;
    if (words.empty())
      std::reverse(word.begin(), word.end());
    else
      word = words.words()[rng.below(static_cast<std::uint32_t>(words.size()))];
  }
  return join_text(out, " ");
}

/// The likeness of every nth caption to its nearest one among other segments, and that of texts of other words.
inline double learned_nearness(const TextTable& table, const SegmentsOfCaption& segments_of) {
  constexpr Index most = 500;
  std::vector<std::string> captions, others;
  std::vector<Index> rows;
  auto rng = Philox{.seed = 1}.split("other words");
  const Index every = std::max<Index>(1, table.size() / most);
  for (Index row = 0; row < table.size(); row += every) {
    captions.push_back(table.texts()[static_cast<std::size_t>(row)]);
    others.push_back(with_other_words(captions.back(), table.words(), rng));
  }
  const auto elsewhere = [&](Index text, Index row) {
    const auto& own = segments_of.at(captions[static_cast<std::size_t>(text)]);
    const auto& of_row = segments_of.at(table.texts()[static_cast<std::size_t>(row)]);
    return std::none_of(of_row.begin(), of_row.end(), [&](std::size_t s) { return own.contains(s); });
  };
  const auto best = [](const std::vector<std::vector<NearText>>& found) {
    std::vector<double> out;
    for (const auto& of_text : found) {
      if (!of_text.empty()) out.push_back(of_text.front().likeness);
    }
    return out;
  };
  return dividing_likeness(best(table.nearest(captions, 1, elsewhere)), best(table.nearest(others, 1)));
}

}  // namespace detail

MOTIONLANG_BODY std::vector<KnownAction> segment_actions(const std::vector<CaptionedSegment>& segments) {
  const auto still = detail::still_poses(segments);
  std::vector<KnownAction> out;
  for (const CaptionedSegment& s : segments) {
    const bool ends = s.rest || (!s.loop && !detail::is_still(s.motion) && detail::comes_to_rest(s.motion));
    out.push_back({.seconds = s.seconds(), .repeats = !ends, .then = detail::text_of_last_pose(s.motion, still)});
  }
  return out;
}

MOTIONLANG_BODY std::vector<std::string> sampled_captions(const CaptionedSegment& segment) {
  std::set<std::string> out(segment.captions.begin(), segment.captions.end());
  if (!segment.loop) return {out.begin(), out.end()};
  for (const std::string& caption : segment.captions) {
    if (const auto back = segment.grounded ? reversed_caption(caption) : std::nullopt) out.insert(*back);
    // A curve, to the left, a half circle, all to the left, and a circle. Their mirror images are known with them.
    constexpr std::pair<double, std::uint32_t> curves[] = {{1, 0}, {1, 2}, {3, 0}, {-5, 0}};
    for (const auto& [turn, wording] : curves) {
      if (const auto curved = curved_caption(caption, turn, wording)) out.insert(*curved);
    }
  }
  return {out.begin(), out.end()};
}

MOTIONLANG_BODY KnownCaptions learned_captions(const TrainingSet& data, TextVectors encode, const WordVectors& words) {
  const auto segments_of = detail::segments_of_captions(data.segments());
  if (segments_of.empty()) return {};
  const auto of_segments = segment_actions(data.segments());
  std::vector<std::string> captions;
  std::vector<KnownAction> actions;
  for (const auto& [caption, segments] : segments_of) {
    const auto repeats =
        std::count_if(segments.begin(), segments.end(), [&](std::size_t s) { return of_segments[s].repeats; });
    KnownAction action{.seconds = 0, .repeats = 2 * repeats > std::ssize(segments), .then = {}};
    double count = 0;
    for (const std::size_t s : segments) {
      if (of_segments[s].repeats != action.repeats) continue;
      action.seconds += of_segments[s].seconds, ++count;
      if (!action.repeats && action.then.empty()) action.then = of_segments[s].then;
    }
    action.seconds /= count;
    captions.push_back(caption);
    actions.push_back(std::move(action));
  }
  const auto table = TextTable::encoded(std::move(captions), std::move(encode), words);
  return {table, std::move(actions), detail::learned_nearness(table, segments_of)};
}

MOTIONLANG_NAMESPACE_END
