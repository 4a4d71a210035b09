// SPDX-License-Identifier: MIT
/// The motion that TEMOS, TMR and SINC decode from the encoding of another, made by the library alone.
#pragma once

#include <motionlang/features/motion_features.hpp>
#include <motionlang/features/normalizer.hpp>
#include <motionlang/kinematics/motion_tools.hpp>

namespace models {

namespace ml = motionlang;

/// The motion, on joints of the features, at their rate `fps`; it begins where the features begin.
template <class Model, ml::Backend B>
ml::Motion denoised(const Model& model, const ml::Normalizer<B>& normalizer, const ml::MotionFeatures& features,
                    const ml::Motion& motion, double fps) {
  const auto rows = features.from_motion(ml::resample(motion, fps));
  const std::vector<typename B::scalar> values(rows.begin(), rows.end());
  const ml::Index frames = std::ssize(values) / features.width;
  const auto x = normalizer.normalize(ml::Tensor<B, 2>::from(values, {frames, features.width}));
  const auto z = model.encode_motion(ml::Sequences<B>(x, ml::Offsets{frames})).mu;
  const auto made = normalizer.denormalize(model.decode(z, ml::Offsets{frames}).rows);
  return ml::motion_of_rows(features, std::vector<double>(made.span().begin(), made.span().end()), fps);
}

}  // namespace models
