// SPDX-License-Identifier: MIT
/// Hyperparameters by name: those of the published programs ("-published"), those of the papers where they differ
/// ("-paper"), and small ones that train in minutes.
///
///     TextMotionConfig config = tmr_preset("small");
///     set_config(config, "optimiser.epochs=20");
///
/// Source   the configurations of the published repositories, which EQUATIONS.md lists; "-paper": thesis A.2.2 (TEACH),
///          B.2.2, B.2.3 and B.3.1 (SINC), TM2T (ECCV 2022), implementation details
/// Differs  from the papers in the attention heads of SINC and TEACH, which cannot be 6 at a width of 256: they are 4
/// Throws   config_error 103 for an unknown name, with the known ones
#pragma once

#include <string>  // names

#include <motionlang/train/tm2t_config.hpp>
#include <motionlang/weights/actor_training_config.hpp>
#include <motionlang/weights/babel_config.hpp>
#include <motionlang/weights/text_motion_config.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// "tmr-published"; "small": minutes on a laptop, without a language model.
TextMotionConfig tmr_preset(const std::string& name);
/// "temos-published", "small".
TextMotionConfig temos_preset(const std::string& name);

/// "sinc-published"; "sinc-paper": batches of 64, a constant rate, 500 epochs, items of at most 600 frames, labels in
/// random order, and weight 1 for all terms (thesis eq. B.1); "small" combines no actions, because that needs a table
/// of body parts.
SincTrainingConfig sinc_preset(const std::string& name);
/// "teach-published"; "teach-paper": rate 1e-4, batches of 32, and padding is masked; "small".
TeachTrainingConfig teach_preset(const std::string& name);

/// "actor-published": the 60 frames of its first training and HumanAct12's 5000 epochs; "actor-published-ntu13": 2000
/// epochs; "actor-published-uestc": 1000 epochs, without motions of fewer than 45 frames; "actor-variable": the 100
/// epochs of fine-tuning after it; "small".
ActorTrainingConfig actor_preset(const std::string& name);
/// "stgcn-published"; "gru-published": the published network, trained as ST-GCN, because its own training is not
/// described anywhere; "small": a GRU.
ClassifierConfig classifier_preset(const std::string& name);

/// "tm2t-published"; "tm2t-published-kit": KIT's; "tm2t-paper": rate 2e-4 in all stages, no discriminator, root and
/// contacts magnified 5 times, true tokens in 0.4 of the batches; "small": minutes to an hour.
Tm2tTrainingConfig tm2t_preset(const std::string& name, Tm2tStage stage);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/presets.ipp>
#endif
