// SPDX-License-Identifier: MIT
// Bodies of training_set.hpp.
#pragma once

#include <algorithm>
#include <cmath>  // sqrt
#include <map>
#include <numbers>  // pi
#include <set>
#include <tuple>    // tie
#include <utility>  // move

#include <motionlang/core/require_value.hpp>
#include <motionlang/datasets/caption_card.hpp>
#include <motionlang/datasets/clip_lines.hpp>
#include <motionlang/datasets/segment_motion.hpp>
#include <motionlang/datasets/training_set.hpp>
#include <motionlang/features/smplrifke.hpp>
#include <motionlang/file/detail/content_hash.hpp>
#include <motionlang/kinematics/blend.hpp>
#include <motionlang/kinematics/curved_path.hpp>
#include <motionlang/kinematics/leading_side.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/kinematics/overlay.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The caption word by word; `other` replaces each word.
template <class Other>
std::string word_by_word(const std::string& caption, Other other) {
  std::string out, word;
  auto flush = [&] {
    out += other(word);
    word.clear();
  };
  for (char c : caption) {
    if (c >= 'a' && c <= 'z')
      word += c;
    else
      flush(), out += c;
  }
  flush();
  return out;
}

inline bool has_word(const std::string& caption, std::initializer_list<std::string_view> beginnings) {
  bool found = false;
  word_by_word(caption, [&](const std::string& word) {
    for (std::string_view b : beginnings) found = found || (!word.empty() && word.starts_with(b));
    return word;
  });
  return found;
}

/// True if a foot stays within 6 cm of the lowest point of the clip at every moment.
inline bool stays_on_the_ground(const Motion& motion) {
  const auto positions = motion.positions();
  const Index joints = motion.skeleton.size();
  double floor = 1e9, highest = 0;
  for (const auto& p : positions) floor = std::min(floor, p.y);
  for (Index f = 0; f < motion.frames(); ++f) {
    const auto* at = positions.data() + f * joints;
    highest = std::max(highest, std::min(at[10].y, at[11].y) - floor);
  }
  return highest < 0.06;
}

inline Motion reversed_motion(const Motion& motion) {
  Motion out = motion;
  for (Index f = 0; f < motion.frames(); ++f) {
    const Index from = motion.frames() - 1 - f;
    out.root[static_cast<std::size_t>(f)] = motion.root_at(from);
    const auto rotations = motion.rotations(from);
    std::copy(rotations.begin(), rotations.end(), out.rotations(f).begin());
  }
  return out;
}

/// The cycle of a clip that consists only of cycles: a quarter of a second round exists, and every pose of the clip is
/// close to one of the cycle. A person who sits still and then rises, or bends and comes up again, also looks alike at
/// two times. But a part of that is not the same action.
inline std::optional<Loop> cycle_of(const Motion& motion) {
  const auto loop = find_loop(motion, 12);
  if (!loop || 4 * (motion.frames() - loop->last + loop->first) < loop->last - loop->first) return std::nullopt;
  const auto poses = detail::poses_in_place(motion);
  const Index joints = motion.skeleton.size();
  double farthest = 0, range = 0;  // metres: from the cycle, from the first pose
  for (Index f = 0; f < motion.frames(); ++f) {
    const auto* pose = poses.data() + f * joints;
    double nearest = 1e9;
    for (Index k = loop->first; k < loop->last; ++k)
      nearest = std::min(nearest, pose_distance(pose, poses.data() + k * joints, joints));
    farthest = std::max(farthest, nearest);
    range = std::max(range, pose_distance(pose, poses.data(), joints));
  }
  return farthest < std::min(0.12, std::max(0.05, 0.7 * range)) ? loop : std::nullopt;
}

/// The verb of a command, and the word after it where the verb says little: "do push-ups", "walk".
inline std::string commanded_action(const std::string& caption) {
  static const std::set<std::string> slight{"be",   "do",   "get",  "give", "go",      "have", "hold",
                                            "keep", "make", "move", "put",  "perform", "stay", "take"};
  std::string verb = commanded_verb(caption);
  if (!slight.contains(verb)) return verb;
  const auto words = caption_words(caption);
  const bool article = words.size() > 2 && (words[1] == "a" || words[1] == "an" || words[1] == "the");
  const std::size_t next = article ? 2 : 1;
  return next < words.size() ? verb + " " + words[next] : verb;
}

/// The action that most commands among the captions are about; "" if there are no commands.
inline std::string commonest_action(const std::vector<std::string>& captions) {
  std::map<std::string, int> actions;
  for (const std::string& c : captions) ++actions[commanded_action(c)];
  actions.erase("");
  const auto fewer = [](const auto& x, const auto& y) { return x.second < y.second; };
  return actions.empty() ? "" : std::max_element(actions.begin(), actions.end(), fewer)->first;
}

/// True if hips, knees, ankles and toes stay within 8 cm of where they are at first, and on the floor.
inline bool legs_are_still(const Motion& motion) {
  const auto positions = motion.positions();
  const Index joints = motion.skeleton.size();
  for (Index f = 0; f < motion.frames(); ++f) {
    for (const Index j : {0, 4, 5, 7, 8, 10, 11}) {
      if (norm(positions[static_cast<std::size_t>(f * joints + j)] - positions[static_cast<std::size_t>(j)]) > 0.08)
        return false;
    }
  }
  return stays_on_the_ground(motion);
}

/// True for captions of walking or running ahead that say no more than how.
inline bool goes_ahead_only(const std::string& caption) {
  return has_word(caption, {"forward", "ahead"}) &&
         has_word(caption, {"walk", "step", "go", "pace", "mov", "stroll", "run", "jog", "sprint"}) &&
         !has_word(caption, {"left", "right", "turn", "up", "down", "stair", "back", "stop", "then", "and", "climb",
                             "lean", "without"});
}

inline bool names_a_side(const std::string& caption) {
  return has_word(caption, {"left", "right", "clockwise", "counterclockwise"});
}

/// Captions that do not say what arms and hands do.
inline std::vector<std::string> without_arms(const std::vector<std::string>& captions) {
  std::vector<std::string> out;
  for (const std::string& c : captions) {
    if (!has_word(c, {"arm", "hand", "elbow", "wrist", "fist", "finger", "hold", "wave", "waving"})) out.push_back(c);
  }
  return out;
}

inline BodyParts arm_parts() { return BodyParts{}.with(BodyPart::left_arm).with(BodyPart::right_arm); }

}  // namespace detail

MOTIONLANG_BODY std::string mirrored_caption(const std::string& caption) {
  static const std::map<std::string, std::string> other{{"left", "right"},
                                                        {"right", "left"},
                                                        {"clockwise", "counterclockwise"},
                                                        {"counterclockwise", "clockwise"},
                                                        {"leftwards", "rightwards"},
                                                        {"rightwards", "leftwards"}};
  return detail::word_by_word(caption, [](const std::string& word) {
    const auto found = other.find(word);
    return found == other.end() ? word : found->second;
  });
}

MOTIONLANG_BODY std::optional<std::string> reversed_caption(const std::string& caption) {
  if (!detail::goes_ahead_only(caption) || detail::has_word(caption, {"run", "jog", "sprint"})) return std::nullopt;
  return detail::word_by_word(caption, [](const std::string& word) -> std::string {
    return word.starts_with("forward") || word == "ahead" ? "backwards" : word;
  });
}

MOTIONLANG_BODY std::optional<std::string> curved_caption(const std::string& caption, double turn,
                                                          std::uint32_t wording) {
  const double degrees = std::abs(turn) * 180 / std::numbers::pi;
  if (!detail::goes_ahead_only(caption) || degrees < 35) return std::nullopt;
  const std::string side = turn > 0 ? "left" : "right", clock = turn > 0 ? "counterclockwise" : "clockwise";
  std::vector<std::string> words{"in a curve to the " + side, "along a curve to the " + side};
  if (degrees < 150) words.push_back("to the " + side);
  if (degrees > 60 && degrees < 120) words.push_back("in a quarter circle to the " + side);
  if (degrees > 150 && degrees < 240) words = {"in a half circle to the " + side, "in a curve to the " + side};
  if (degrees >= 240) {
    words = {"in a circle to the " + side, clock + " in a circle", "in a " + clock + " circle"};
    if (turn < 0) words.insert(words.begin(), "in a circle");
  }
  bool said = false;
  const std::string out = detail::word_by_word(caption, [&](const std::string& word) -> std::string {
    const bool way = word.starts_with("forward") || word == "ahead" || word.starts_with("straight");
    return !way ? word : std::exchange(said, true) ? "" : words[wording % words.size()];
  });
  return join_text(detail::caption_words(out), " ", [](const std::string& word) { return word; });
}

MOTIONLANG_BODY TrainingSet::TrainingSet(const std::filesystem::path& captions, const std::filesystem::path& data,
                                         Progress progress) {
  const auto lines = read_captions(captions, data);
  std::map<std::string, Motion> clips;
  const auto clip_of = [&](const ClipLine& line) {
    auto found = clips.find(line.clip);
    if (found == clips.end()) found = clips.emplace(line.clip, resample(read_clip(data, line), training_fps)).first;
    return found->second;
  };
  for (std::size_t i = 0; i < lines.size(); ++i) {
    progress(static_cast<Index>(i), std::ssize(lines));
    const ClipLine& line = lines[i];
    SegmentMotion found = segment_motion(line, clip_of, 8);
    CaptionedSegment s{line.clip, std::move(found.motion), line.parts, line.texts, found.cycle};
    s.rest = found.rest, s.action = found.action;
    if (!s.loop && !s.rest) s.loop = detail::cycle_of(s.motion);
    s.grounded = detail::stays_on_the_ground(s.motion);
    s.side = leading_side(s.motion, s.parts);
    segments_.push_back(std::move(s));
  }
  weigh();
  list_choices();
}

MOTIONLANG_BODY void TrainingSet::list_choices() {
  all_ = bases_ = still_ = overlays_ = {};
  for (std::size_t i = 0; i < segments_.size(); ++i) {
    const CaptionedSegment& s = segments_[i];
    const bool arms = (s.parts.bits & detail::arm_parts().bits) != 0, legs = s.parts.has(BodyPart::legs);
    all_.add(i, s.weight);
    if (!arms && legs) bases_.add(i, s.weight);
    if ((arms || s.parts.has(BodyPart::head)) && !legs) overlays_.add(i, s.weight);
    if (arms && legs && detail::legs_are_still(s.motion)) still_.add(i, s.weight);
  }
}

MOTIONLANG_BODY void TrainingSet::weigh() {
  std::map<std::string, double> segments_about;
  for (const CaptionedSegment& s : segments_) {
    std::set<std::string> actions;
    for (const std::string& c : s.captions) actions.insert(detail::commanded_action(c));
    for (const std::string& action : actions) ++segments_about[action];
  }
  constexpr double common = 100, most = 4;
  for (CaptionedSegment& s : segments_) {
    const std::string action = detail::commonest_action(s.captions);
    if (!action.empty()) {
      const auto found = std::find(verbs_.begin(), verbs_.end(), action);
      s.verb = found - verbs_.begin();
      if (found == verbs_.end()) verbs_.push_back(action);
    }
    s.weight = action.empty() ? 1 : std::clamp(std::sqrt(common / segments_about[action]), 1.0, most);
  }
}

MOTIONLANG_BODY void SampleOptions::require_sound() const {
  require_value("shortest", shortest, shortest >= 2, "2 or more");
  for (const auto& [name, value] : {std::pair("no_text", no_text),
                                    {"compose", compose},
                                    {"still", still},
                                    {"passing", passing},
                                    {"mirror", mirror},
                                    {"tempo", tempo},
                                    {"reverse", reverse},
                                    {"curve", curve},
                                    {"then", then}})
    require_value(name, value, value >= 0 && value <= 1, "0 to 1");
  require_value("speed", speed, speed >= 0 && speed < 1, "0 or more, and less than 1");
  require_value("stretch", stretch, stretch > 0 && stretch <= 1, "above 0, and at most 1");
}

MOTIONLANG_BODY std::vector<std::size_t> TrainingSet::saying(std::span<const std::string> words) const {
  const auto spaced = [](const std::string& text) { return " " + join_text(detail::caption_words(text), " "); };
  std::vector<bool> chosen(segments_.size(), words.empty());
  for (const std::string& word : words) {
    const std::string start = spaced(word);
    bool found = false;
    for (std::size_t i = 0; i < segments_.size() && start != " "; ++i) {
      for (const std::string& caption : segments_[i].captions) {
        if (spaced(caption).find(start) != std::string::npos) chosen[i] = found = true;
      }
    }
    if (!found) raise<config_error>(102, "TrainingSet: no caption has \"", word, "\", so none can be chosen by it");
  }
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < segments_.size(); ++i) {
    if (chosen[i]) out.push_back(i);
  }
  return out;
}

MOTIONLANG_BODY void TrainingSet::practise(std::span<const std::string> words, double factor) {
  if (!(factor > 0)) raise<config_error>(101, "TrainingSet: words are practised ", factor, " times as often");
  if (words.empty()) return;
  for (const std::size_t i : saying(words)) segments_[i].weight *= factor;
  list_choices();
}

MOTIONLANG_BODY const CaptionedSegment& TrainingSet::pick(const Choice& choice, Philox& rng) const {
  const double at = rng.uniform() * choice.until.back();
  const auto found = std::upper_bound(choice.until.begin(), choice.until.end() - 1, at);
  return segments_[choice.segments[static_cast<std::size_t>(found - choice.until.begin())]];
}

MOTIONLANG_BODY double TrainingSet::seconds() const {
  double total = 0;
  for (const CaptionedSegment& s : segments_) total += s.seconds();
  return total;
}

MOTIONLANG_BODY std::string TrainingSet::fingerprint() const {
  std::uint64_t hash = 0;
  auto add = [&](const auto& list) { hash = detail::content_hash(std::as_bytes(std::span(list)), hash); };
  for (const CaptionedSegment& s : segments_) {
    add(s.motion.root);
    add(s.motion.local);
    add(std::span(&s.parts, 1));
    for (const std::string& c : s.captions) add(c);
    std::vector<Index> goes_on{s.action};
    if (s.loop) goes_on.insert(goes_on.end(), {s.loop->first, s.loop->last});
    if (s.rest) goes_on.push_back(-1);
    add(goes_on);
  }
  return detail::hexadecimal(hash);
}

MOTIONLANG_BODY std::vector<std::string> TrainingSet::all_captions() const {
  std::vector<std::string> out;
  for (const CaptionedSegment& s : segments_) {
    for (const std::string& c : s.captions) {
      out.push_back(c);
      out.push_back(mirrored_caption(c));
    }
  }
  out.emplace_back(added_caption_words);
  return out;
}

MOTIONLANG_BODY Motion TrainingSet::variant(const CaptionedSegment& s, Index frames, bool mirrored, double tempo,
                                            Philox& rng, const SampleOptions& options) const {
  double factor = tempo * (1 + options.speed * (2 * rng.uniform() - 1));
  if (!s.loop && !s.rest && s.grounded && tempo == 1) {  // an action takes longer if there is time for it
    factor *= std::clamp(static_cast<double>(s.motion.frames()) / static_cast<double>(frames), options.stretch, 1.0);
  }
  const auto wanted = static_cast<Index>(static_cast<double>(frames) * factor) + 1;  // before the change of speed
  Motion m = s.motion;
  if (s.loop && m.frames() < wanted) m = go_round(m, *s.loop, wanted);
  if (s.rest) {  // the whole action in its own time, and what follows
    const Index until = std::clamp(wanted, s.action, longest_rest * s.action);
    m = m.frames() < until ? go_round(m, *s.rest, until) : crop(m, 0, until);
  } else if (m.frames() > wanted && s.loop) {  // any part of a cyclic motion is that motion
    const auto first = static_cast<Index>(rng.below(static_cast<std::uint32_t>(m.frames() - wanted + 1)));
    m = crop(m, first, first + wanted);
  } else {  // otherwise the whole action, with up to a tenth cut off at the ends
    const auto spare = static_cast<std::uint32_t>(m.frames() / 10 + 1);
    const auto cut = static_cast<Index>(rng.below(spare)),
               before = static_cast<Index>(rng.below(static_cast<std::uint32_t>(cut + 1)));
    m = crop(m, before, m.frames() - (cut - before));
  }
  m = change_speed(m, factor);
  if (m.frames() > options.longest) m = crop(m, 0, options.longest);
  return mirrored ? mirror(m) : m;
}

namespace detail {

/// One of the captions of a segment, and whether its motion is mirrored: `mirrored`, unless the motion prefers a side
/// that the caption does not name.
inline std::pair<std::string, bool> said(const CaptionedSegment& s, const std::vector<std::string>& captions,
                                         bool mirrored, Philox& rng) {
  if (captions.empty()) return {"", mirrored};
  const auto& c = captions[rng.below(static_cast<std::uint32_t>(captions.size()))];
  if (s.side != Side::middle && !names_a_side(c)) return {c, s.side == Side::left};
  return {mirrored ? mirrored_caption(c) : c, mirrored};
}

}  // namespace detail

MOTIONLANG_BODY std::optional<std::pair<Motion, std::string>> TrainingSet::two_actions(
    Index frames, bool mirrored, Philox& rng, const SampleOptions& options) const {
  constexpr Index blend = 8;          // frames
  constexpr double most_apart = 0.2;  // metres, as a mean over the joints
  const auto drawn = [&] {
    const CaptionedSegment& s = pick(all_, rng);
    auto [caption, other_way] = detail::said(s, s.captions, mirrored, rng);
    return std::pair(variant(s, frames / 2, other_way, 1, rng, options), std::move(caption));
  };
  const auto short_enough = [&](const Motion& m, Index others) {
    return m.frames() > 2 * blend && m.frames() + others - blend <= options.longest;
  };
  const auto [first, says_first] = drawn();
  if (!short_enough(first, 2 * blend)) return std::nullopt;
  const Index joints = first.skeleton.size();
  const auto end = detail::poses_in_place(crop(first, first.frames() - 1, first.frames()));
  for (int tries = 0; tries < 6; ++tries) {
    const auto [second, says] = drawn();
    if (!short_enough(second, first.frames())) continue;
    const auto start = detail::poses_in_place(crop(second, 0, 1));
    if (detail::pose_distance(end.data(), start.data(), joints) > most_apart) continue;
    const char* const between[] = {" and then ", " then ", " and ", ", then "};
    return std::pair(blend_into(first, second, blend), says_first + between[rng.below(4)] + says);
  }
  return std::nullopt;
}

MOTIONLANG_BODY TrainingSample TrainingSet::draw(Philox rng, const SampleOptions& options) const {
  const Index range = options.longest - options.shortest;
  // Short lengths are more frequent than long ones, because most texts of a timeline last a few seconds.
  const Index frames = options.shortest + static_cast<Index>(static_cast<double>(range) * std::pow(rng.uniform(), 3));
  const bool drawn = rng.uniform() < options.mirror;
  TrainingSample sample;
  Motion motion;
  const auto bases = [&]() -> const Choice& {
    return !still_.empty() && rng.uniform() < options.still ? still_ : bases_;
  };
  auto both = rng.uniform() < options.then ? two_actions(frames, drawn, rng, options) : std::nullopt;
  if (both) {
    motion = std::move(both->first);
    sample.caption = std::move(both->second);
  } else if (!bases_.empty() && !overlays_.empty() && rng.uniform() < options.compose) {
    const CaptionedSegment &base = pick(bases(), rng), &overlay = pick(overlays_, rng);
    const auto [about_arms, mirrored] = detail::said(overlay, overlay.captions, drawn, rng);
    const auto [about_legs, other_way] = detail::said(base, detail::without_arms(base.captions), drawn, rng);
    const auto with = variant(overlay, frames, mirrored, 1, rng, options);
    BodyParts parts = overlay.parts;
    if (mirrored) {
      const bool left = parts.has(BodyPart::left_arm), right = parts.has(BodyPart::right_arm);
      parts.bits &= ~detail::arm_parts().bits;
      if (left) parts = parts.with(BodyPart::right_arm);
      if (right) parts = parts.with(BodyPart::left_arm);
    }
    constexpr Index blend = 8;  // frames
    const bool passing = !about_legs.empty() && rng.uniform() < options.passing;
    const Index length = std::min(options.longest, (passing ? 2 : 1) * with.frames());
    motion = variant(base, length, other_way, 1, rng, options);
    if (passing && motion.frames() > 4 * blend) {
      const auto first = static_cast<Index>(rng.below(static_cast<std::uint32_t>(motion.frames() - 2 * blend)));
      motion = overlay_parts_for_a_while(motion, with, parts, first, blend);
      sample.caption = about_legs, sample.verb = base.verb;
    } else {
      motion = overlay_parts(motion, with, parts);
      const double which = rng.uniform();
      if (which < 0.45 || about_legs.empty())
        sample.caption = about_arms, sample.verb = overlay.verb;
      else if (which < 0.7)
        sample.caption = about_legs, sample.verb = base.verb;
      else
        sample.caption = which < 0.85 ? about_legs + " while " + about_arms : about_arms + " and " + about_legs;
    }
  } else {
    const CaptionedSegment& s = pick(all_, rng);
    bool mirrored = false;
    std::tie(sample.caption, mirrored) = detail::said(s, s.captions, drawn, rng);
    sample.verb = s.verb;
    double tempo = 1;
    if (s.grounded && rng.uniform() < options.tempo &&
        !detail::has_word(sample.caption, {"slow", "quick", "fast", "calm", "stand"})) {
      const bool slow = rng.uniform() < 0.5;
      tempo = slow ? 0.6 : 1.6;
      sample.caption += slow ? " slowly" : " quickly";
    }
    const auto backwards = s.loop && s.grounded ? reversed_caption(sample.caption) : std::nullopt;
    motion = variant(s, frames, mirrored, tempo, rng, options);
    if (backwards && rng.uniform() < options.reverse) {
      motion = detail::reversed_motion(motion);
      sample.caption = *backwards;
    } else if (s.loop && detail::goes_ahead_only(sample.caption) && rng.uniform() < options.curve) {
      const bool runs = detail::has_word(sample.caption, {"run", "jog", "sprint"});
      const double radius = (0.7 + 1.3 * rng.uniform()) * (runs ? 2 : 1), turn = path_length(motion) / radius;
      const bool left = rng.uniform() < 0.5;
      if (const auto bent = curved_caption(sample.caption, left ? turn : -turn, rng.below(16))) {
        motion = curved_path(motion, (left ? 1 : -1) / radius);
        sample.caption = *bent;
      }
    }
  }
  if (motion.frames() < 4) return draw(rng.split("again"), options);
  if (rng.uniform() < options.no_text) sample.caption.clear(), sample.verb = -1;
  const auto features = smplrifke_from_motion(motion);
  sample.features.assign(features.begin(), features.end());
  sample.frames = motion.frames();
  return sample;
}

MOTIONLANG_NAMESPACE_END
