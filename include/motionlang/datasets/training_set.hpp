// SPDX-License-Identifier: MIT
/// The training set of the bundled model: captioned segments of motion capture, and random samples from them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>  // pair
#include <vector>

#include <motionlang/core/fields.hpp>
#include <motionlang/core/progress.hpp>
#include <motionlang/core/rng.hpp>
#include <motionlang/kinematics/body_parts.hpp>
#include <motionlang/kinematics/joint_sides.hpp>
#include <motionlang/kinematics/loops.hpp>
#include <motionlang/kinematics/motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// One line of captions.tsv, with its motion on the 24-joint skeleton at 20 frames per second, on the floor
/// (ground_recording). What repeats on the spot while its feet slide goes ahead instead (off_treadmill).
struct CaptionedSegment {
  std::string clip;
  Motion motion;
  BodyParts parts;  // that the captions describe
  std::vector<std::string> captions;
  std::optional<Loop> loop;    // for a motion that repeats one cycle, so that it can start and end anywhere
  bool grounded = true;        // never in the air, so it may be played slower or faster
  std::optional<Loop> rest{};  // at the end of the motion: continues an action for any time
  Index action = 0;            // frames before that; all frames if nothing follows
  Side side = Side::middle;    // that it prefers (leading_side)
  Index verb = -1;             // in TrainingSet::verbs(): what most of its commands tell to do; -1: it has none
  double weight = 1;  // relative probability of drawing it; up to 4, if few segments show what its captions say

  /// The length of the segment, without what follows.
  double seconds() const { return static_cast<double>(action) / motion.fps; }
};

/// One training sample: features (frames, 205), not normalised, and a caption.
struct TrainingSample {
  std::vector<float> features;
  Index frames = 0;
  std::string caption;
  Index verb = -1;  // in TrainingSet::verbs(): what the caption is about; -1: nothing, two actions or no command
};

inline constexpr double training_fps = 20;
/// An action and what follows it are drawn with at most this many times the length of the action.
inline constexpr Index longest_rest = 3;

/// The words that samples add to captions.
inline constexpr std::string_view added_caption_words =
    "while and then slowly quickly backwards in a circle curve along the half quarter to clockwise counterclockwise";

struct SampleOptions {
  Index shortest = 16, longest = 196;  // frames
  double no_text = 0.1;                // probability of the caption ""
  double compose = 0.35;               // probability that the arms come from another segment
  double still = 0.3;                  // share of these whose legs stand, sit or kneel still
  double passing = 0.4;                // share of these whose arms do it for a while, and the caption does not say it
  double mirror = 0.5;                 // probability, where the caption names a side or the motion prefers none
  double speed = 0.2;                  // factors 1 - speed ... 1 + speed
  double stretch = 0.5;                // the slowest factor at which one whole action fills a longer sample
  double tempo = 0.15;                 // probability of half or nearly twice the speed; the caption says so
  double reverse = 0.3;                // probability that steady walking ahead is played backwards; the caption says so
  double curve = 0.6;                  // probability that steady walking or running ahead is bent; the caption says so
  double then = 0.12;                  // probability that a second action follows; the caption has both

  void require_sound() const;
  static constexpr auto fields() {
    using C = SampleOptions;
    return motionlang::fields("shortest", &C::shortest, "longest", &C::longest, "no_text", &C::no_text, "compose",
                              &C::compose, "still", &C::still, "passing", &C::passing, "mirror", &C::mirror, "speed",
                              &C::speed, "stretch", &C::stretch, "tempo", &C::tempo, "reverse", &C::reverse, "curve",
                              &C::curve, "then", &C::then);
  }
};

class TrainingSet {
 public:
  /// Reads captions.tsv and the clips that it names below `data`. `progress` receives the number of clips read. Throws
  /// io_error 401, 403.
  TrainingSet(const std::filesystem::path& captions, const std::filesystem::path& data, Progress progress);

  const std::vector<CaptionedSegment>& segments() const { return segments_; }
  /// The actions that the captions command, each once: "walk", "do push-ups".
  const std::vector<std::string>& verbs() const { return verbs_; }
  double seconds() const;
  /// 16 digits that change with any clip or caption.
  std::string fingerprint() const;
  /// All captions and their mirror images, from which a tokenizer learns.
  std::vector<std::string> all_captions() const;

  /// The segments, by their places, of which a caption has one of these words or phrases ("nod" also finds "nods" and
  /// "nodding"). No words: all. Throws config_error 102 for words that no caption has.
  std::vector<std::size_t> saying(std::span<const std::string> words) const;

  /// Makes segments `factor` times as likely to be drawn if they say one of these words: what `motionlang judge`
  /// still sees fail. Throws config_error 101 for a factor that is not above 0, and what `saying` throws.
  void practise(std::span<const std::string> words, double factor);

  /// A sample that depends only on the generator. It is one of these:
  ///   - a segment: mirrored, faster or slower, with its cycle repeated if it has one, or a part of it
  ///   - an action in its own time and then its continuation, if the table has one
  ///   - a segment slower or faster, backwards in time, or along a curve, if the caption can say so
  ///   - two segments one after the other, under both captions
  ///   - a segment about the legs with the arms of another one about the arms, under either caption or both (as SINC).
  ///     The legs may be those of a person who stands or sits still, under a caption that does not mention arms
  ///   - the same for a while only, under the caption about the legs. In a timeline the model sees arms that another
  ///     text moves. It should neither raise them before nor leave them there
  ///   - one of these with the caption "", sometimes
  /// A motion that prefers a side, under a caption that names none, always prefers the right: the right hand waves.
  /// With both sides the model would learn the mean of them, which waves with neither.
  TrainingSample draw(Philox rng, const SampleOptions& options) const;

 private:
  Motion variant(const CaptionedSegment& s, Index frames, bool mirrored, double tempo, Philox& rng,
                 const SampleOptions& options) const;
  /// A segment and one that begins in a similar pose, blended into each other; nothing if none was found in few tries.
  std::optional<std::pair<Motion, std::string>> two_actions(Index frames, bool mirrored, Philox& rng,
                                                            const SampleOptions& options) const;
  /// Segments of which one is drawn, the likelier the larger its weight.
  struct Choice {
    std::vector<std::size_t> segments{};
    std::vector<double> until{};  // sums of weights

    void add(std::size_t segment, double weight) {
      segments.push_back(segment);
      until.push_back((until.empty() ? 0 : until.back()) + weight);
    }
    bool empty() const { return segments.empty(); }
  };
  const CaptionedSegment& pick(const Choice& choice, Philox& rng) const;
  void weigh();
  /// Fills the choices with the segments and their weights.
  void list_choices();

  std::vector<CaptionedSegment> segments_;
  std::vector<std::string> verbs_{};
  Choice all_{}, bases_{}, still_{}, overlays_{};  // bases: nothing about the arms; overlays: only arms, head, spine
};

/// The caption of steady walking that is played backwards in time: "forward" and "ahead" become "backwards". Nothing
/// for captions that name no direction, or say more than that.
std::optional<std::string> reversed_caption(const std::string& caption);

/// The caption of steady walking or running along a curve: "forward" and "ahead" become "in a circle to the left", "to
/// the right", ...  Nothing for captions that name no direction, or say more than that.
/// turn     radians in all, above 0 to the left. "in a circle" alone is to the right, as all that names no side
/// wording  chooses among the words for that turn
std::optional<std::string> curved_caption(const std::string& caption, double turn, std::uint32_t wording);

/// Exchanges "left" and "right", and "clockwise" and "counterclockwise", word by word.
std::string mirrored_caption(const std::string& caption);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/training_set.ipp>
#endif
