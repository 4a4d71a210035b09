// Generated features as motions that can be written to files.
#pragma once

#include <string>
#include <vector>

#include <motionlang/core/rng.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/kinematics/motion.hpp>

#include "../generate/generation.hpp"

namespace program {

/// The features that the library names which a model of this layout and width makes. Throws config_error 103.
const ml::MotionFeatures& features_of_layout(const std::string& layout, ml::Index width);

/// rows      (frames, features), not normalised
/// layout    a model's: smplrifke, facing as published; guoh3dfeats, of HumanML3D or KIT; or features that the library
///           names
/// Throws    config_error 103 for another layout
ml::Motion motion_of_features(const std::string& layout, const std::vector<double>& rows, ml::Index width, double fps);

/// Rows of features that the library names. fps: 0 is their own.
ml::Motion motion_of_features(const ml::MotionFeatures& features, std::span<const float> rows, double fps = 0);

/// What a published TEMOS, or SINC, of so many numbers a frame reads.
inline const ml::MotionFeatures& published_temos_features(ml::Index width) {
  return ml::motion_features(width == 64 ? "rifke64" : "smplvelp-published");
}

/// A model that makes every motion alone, from its texts and from noise that depends on the seed and on its place.
class EachAlone : public Generator {
 public:
  std::vector<ml::Motion> run(const std::vector<ml::Timeline>& timelines, const GenerationSettings& settings,
                              ml::Progress progress) const final;

 protected:
  /// Of the motion at this place.
  static ml::Philox noise_of(const GenerationSettings& settings, std::uint64_t place) {
    return ml::Philox{.seed = settings.seed}.split("noise").split(place);
  }

 private:
  virtual ml::Motion motion(const ml::Timeline& timeline, ml::Philox noise,
                            const GenerationSettings& settings) const = 0;
};

/// Without trembling and with feet that stand, as the settings say; feet are those of SMPL's or KIT's joints.
ml::Motion finished(ml::Motion motion, const GenerationSettings& settings);

}  // namespace program
