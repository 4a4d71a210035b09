// SPDX-License-Identifier: MIT
/// Motions that a model remembers for its captions (compose/recalled_motions.hpp).
///
/// A text recalls a motion if the caption nearest to it has one, or another that is nearly as alike
/// (KnownCaptions::meant). If that is the mirror image of a caption, the motion is mirrored, too. An action that goes
/// on (KnownAction::repeats) is played at its own speed, in rounds. Another is played faster or slower, so that it
/// takes the time of the text. If there is much more time, it is played again, or its last pose is held if that is not
/// like its first.
#pragma once

#include <motionlang/compose/motion_recall.hpp>
#include <motionlang/kinematics/motion.hpp>
#include <motionlang/text/known_captions.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A caption, by its line in the table, has a motion, by its place in the memory.
struct RememberedMotion {
  Index caption = 0, motion = 0;
  bool operator==(const RememberedMotion&) const = default;
};

class MotionMemory final : public MotionRecall {
 public:
  /// motions  on SMPL's 24 joints, all at one frame rate, which is that of the model
  /// of       which caption has which motions; a caption may have several
  /// source   stands in messages, such as the name of a file
  /// Throws   shape_error 203 for a caption or a motion that does not exist, and for an empty motion; config_error 102
  ///          for motions of other joints, or of several frame rates; what Motion::validate throws
  MotionMemory(KnownCaptions captions, std::vector<Motion> motions, std::vector<RememberedMotion> of,
               std::string_view source = "MotionMemory");

  const KnownCaptions& captions() const { return captions_; }
  const KnownCaptions* known() const override { return &captions_; }
  const std::vector<Motion>& motions() const { return motions_; }
  const std::vector<RememberedMotion>& remembered() const { return of_; }
  /// The number of captions that have a motion.
  Index captions_with_motions() const;

  /// The motion for a text, in as many frames. Nothing if no motion is known.
  std::optional<Motion> motion(const std::string& text, Index frames, double choice) const;

  /// The same as features of STMC (features/smplrifke.hpp).
  std::vector<double> features(const std::string& text, Index frames, double choice) const override;
  std::string fingerprint() const override;

 private:
  KnownCaptions captions_;
  std::vector<Motion> motions_;
  std::vector<RememberedMotion> of_;  // sorted
};

/// How a motion is played in another time.
enum class PlayedAgain {
  no,        // its own speed, and its last pose is held; 1.5 times as fast at most, and then its end is left out
  to_fit,    // faster or slower, 1.5 times at most, and in rounds where one would have to be slower
  as_it_is,  // its own speed, in rounds, of which the last one is cut
};
/// A motion in exactly this many frames. A round is blended into the one before it. Throws shape_error 203 unless both
/// have frames.
Motion played_in(const Motion& motion, Index frames, PlayedAgain again = PlayedAgain::to_fit);

/// True if the last pose of a motion, with its heading, is within 30 degrees of the first one in every joint.
bool comes_back(const Motion& motion);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/motion_memory.ipp>
#endif
