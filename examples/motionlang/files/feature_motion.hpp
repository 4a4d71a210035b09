// Generated features as motions that can be written to files.
#pragma once

#include <string>
#include <vector>

#include <motionlang/core/rng.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/kinematics/motion.hpp>

#include "../generate/generation.hpp"

namespace program {

/// rows      (frames, features), not normalised, of one of these layouts:
///           smplrifke (205): rotations of SMPL, facing as published; guoh3dfeats of 22 joints (263): SMPL's skeleton with the
///           lengths and the directions of the predicted positions; of 21 joints (251): KIT's skeleton, in metres;
///           rifke (64): the same skeleton; smplvelp (135): rotations of SMPL
/// Throws    config_error 103 for another layout
ml::Motion motion_of_features(const std::string& layout, const std::vector<double>& rows, ml::Index width, double fps);

/// Rows of features that the library names, as a clip on SMPL's 24 joints.
ml::Motion motion_of_features(const ml::MotionFeatures& features, std::span<const float> rows);

/// A model that makes every motion alone, from its texts and from noise that depends on the seed and on its place.
class EachAlone : public Generator {
 public:
  std::vector<ml::Motion> run(const std::vector<ml::Timeline>& timelines, const GenerationSettings& settings,
                              ml::Progress progress) const final;

 private:
  virtual ml::Motion motion(const ml::Timeline& timeline, ml::Philox noise, const GenerationSettings& settings) const = 0;
};

/// Without trembling and with feet that stand, as the settings say; feet are those of SMPL's skeleton.
ml::Motion finished(ml::Motion motion, const GenerationSettings& settings);

}  // namespace program
