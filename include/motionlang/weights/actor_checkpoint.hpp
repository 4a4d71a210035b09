// SPDX-License-Identifier: MIT
/// ACTOR from one folder: one that train-actor wrote, or the published one (opt.yaml, checkpoint_5000.pth.tar).
///
///     const auto actor = load_actor<B>("exps/humanact12");
///     Philox rng{.seed = 7};
///     const auto rows = generate(actor.actor, classes, lengths, rng);
///
/// Source  Petrovich et al. (ICCV 2021); thesis, chapter 3
#pragma once

#include <motionlang/weights/actor_model.hpp>
#include <motionlang/weights/text_motion_checkpoint.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The network with its actions and with the settings of its training clips. Throws what the readers throw: io_error
/// 401 for a missing file, 403 to 407; config_error 101, 102, 103, 107.
template <Backend B>
ActorModel<B> load_actor(const FilePath& path) {
  return ActorModel<B>(found_model_folder(path));
}

MOTIONLANG_NAMESPACE_END
