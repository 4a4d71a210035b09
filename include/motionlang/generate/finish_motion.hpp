// SPDX-License-Identifier: MIT
/// Turns the features that a model generates into a finished motion: rows of features become a motion, which is
/// smoothed and gets its floor and feet fixed.
///
///     Motion m = motion_of_features(stmc.layout.name, rows, stmc.layout.size, stmc.fps);
///     m = finish_motion(std::move(m), {});
#pragma once

#include <motionlang/features/motion_features.hpp>
#include <motionlang/generate/generate_options.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The named features of a model with this layout and width: "guoh3dfeats" is HumanML3D's or KIT's. Throws config_error
/// 103 for another layout.
const MotionFeatures& features_of_layout(std::string_view layout, Index width);

/// rows    (frames, width), not normalised
/// layout  that of a model: "smplrifke", which starts facing pi as published; "guoh3dfeats" of HumanML3D or KIT; or the
///         name of any motion_features
/// Throws  config_error 103 for another layout, and what motion_of_rows throws
Motion motion_of_features(std::string_view layout, std::span<const double> rows, Index width, double fps);
/// fps: 0 is the rate of the features.
Motion motion_of_features(const MotionFeatures& features, std::span<const float> rows, double fps = 0);

/// Finishes a motion as the options say. It removes jitter (smooth_motion), keeps the body on the floor
/// (stand_on_floor), keeps standing feet from sliding (fix_feet) and lifts feet that sink in (lift_sunken_feet). Floor
/// and feet are fixed on skeletons with known_legs. Feet come last, because standing feet must not move again.
Motion finish_motion(Motion motion, const GenerateOptions& options);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/finish_motion.ipp>
#endif
