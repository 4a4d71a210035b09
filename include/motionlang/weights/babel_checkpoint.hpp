// SPDX-License-Identifier: MIT
/// Models that make a motion from one text, for comparison on BABEL: a SINC or a TEACH, trained here or published, or a
/// published TEMOS.
///
///     with_babel_checkpoint<B>("sinc-run", {}, motion_features("smplvelp"), [&](auto model) {
///       use(model.encode_motion(motion));                    // a TextMotionCheckpoint
///     });
#pragma once

#include <motionlang/datasets/babel_motions.hpp>
#include <motionlang/weights/sinc_checkpoint.hpp>
#include <motionlang/weights/teach_checkpoint.hpp>
#include <motionlang/weights/temos_checkpoint.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Calls f with the checkpoint in a folder.
/// features  that the model must have, at babel_fps
/// Throws    config_error 102 for other features or another rate, 103 for another system, and what the loaders throw
template <Backend B, class F>
void with_babel_checkpoint(const std::filesystem::path& folder, const CheckpointOptions& options,
                           const MotionFeatures& features, F f) {
  const auto take = [&](auto model) {
    if (model.features->name != features.name || model.fps != babel_fps)
      raise<config_error>(102, folder.string(), ": a model of ", model.features->name, " at ", model.fps,
                          " frames per second, the motions are ", features.name, " at ", babel_fps);
    f(std::move(model));
  };
  const bool ours = find_run(folder).system == "motionlang";
  const std::string system = ours ? read_model_folder(folder).system : system_of_run(folder);
  if (system == "sinc")
    take(load_sinc<B>(folder, options));
  else if (system == "teach")
    take(load_teach<B>(folder, options));
  else if (system == "temos" && !ours)
    take(load_temos<B>(folder, options));
  else
    raise<config_error>(103, folder.string(), ": a model of '", system,
                        "'; expected sinc or teach, or temos as published");
}

MOTIONLANG_NAMESPACE_END
