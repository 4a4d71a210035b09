// Models with one latent for every motion (ACTOR, TEMOS, TMR, SINC) behind the Generator: motions between two, and
// motions without their noise.
#pragma once

#include "../files/feature_motion.hpp"
#include "../files/motion_files.hpp"

namespace program {

class FromLatent : public EachAlone {
 public:
  std::string system() const final { return "a model with one latent for every motion"; }
  bool draws_latents() const override { return true; }

  /// `count` motions on the straight line from the latent of one timeline to that of another, which is as long, with
  /// the same noise: the first and the last are those that `run` makes of either alone. Throws usage_error 101 unless
  /// count is 2 or more.
  std::vector<ml::Motion> between(const ml::Timeline& from, const ml::Timeline& to, ml::Index count,
                                  const GenerationSettings& settings) const;

  /// A motion as its latent keeps it, on the joints of the model: encoded, decoded, put where it was, at its rate. One
  /// that is longer than those that the model learned from goes through it in parts, which share a quarter of their
  /// frames and are blended.
  /// action  of the motion, for ACTOR; "" for others
  /// Throws  usage_error 102 where the action is missing or not asked for, config_error 103 for an unknown one, and
  ///         what the features throw
  ml::Motion denoised(const ml::Motion& motion, const std::string& action) const;

 protected:
  /// Rows as a model reads them.
  static std::vector<float> as_floats(const std::vector<double>& rows) { return {rows.begin(), rows.end()}; }

 private:
  virtual std::vector<ml::Motion> line(const ml::Timeline& from, const ml::Timeline& to, ml::Index count,
                                       ml::Philox noise, double fact) const = 0;
  /// Encoded and decoded. The motion has the rate of the model.
  virtual ml::Motion decoded(const ml::Motion& motion, const std::string& action) const = 0;
  virtual ml::Index longest() const = 0;  // frames that the model learned from
  /// The motion on joints that `decoded` takes: SMPL's 24, or those of the model's features.
  virtual ml::Motion on_its_joints(const ml::Motion& motion) const = 0;
};

/// The generator as such a model. Throws usage_error 102 for another.
/// option  what asks for it;   model   where it was loaded from
const FromLatent& from_latent(const Generator& generator, const std::string& option,
                              const std::filesystem::path& model);

}  // namespace program
