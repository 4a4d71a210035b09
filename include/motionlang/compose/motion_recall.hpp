// SPDX-License-Identifier: MIT
/// A class that finds motions for texts. Clean estimates of a collage follow them (compose/recalled_motions.hpp).
#pragma once

#include <string>  // texts
#include <vector>  // features

#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

class KnownCaptions;  // text/known_captions.hpp

/// Finds motions for texts. datasets/motion_memory.hpp has one; any other may be written.
class MotionRecall {
 public:
  MotionRecall() = default;
  MotionRecall(const MotionRecall&) = delete;
  MotionRecall& operator=(const MotionRecall&) = delete;
  virtual ~MotionRecall() = default;

  /// The features of a motion for the text, (frames, features), not normalised. Nothing if no motion is known.
  /// choice  in 0 ... 1: chooses one, if there are several. The same arguments give the same motion
  virtual std::vector<double> features(const std::string& text, Index frames, double choice) const = 0;
  /// The captions by which it finds motions; null: it does not find them so.
  virtual const KnownCaptions* known() const { return nullptr; }
  /// Digits that change with any motion or text.
  virtual std::string fingerprint() const = 0;
};

/// The share of the remembered motion that is usual.
inline constexpr double usual_recall = 0.9;

MOTIONLANG_NAMESPACE_END
