// SPDX-License-Identifier: MIT
/// Hyperparameters by name: those of the papers, and small ones that train in minutes.
///
///     TextMotionConfig config = tmr_preset("small");
///     set_config(config, "optimiser.epochs=20");
///
/// Source   the configurations of the published repositories, which EQUATIONS.md lists
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

/// "sinc-published"; "small" combines no actions, because that needs a table of body parts.
SincTrainingConfig sinc_preset(const std::string& name);
/// "teach-published", "small".
TeachTrainingConfig teach_preset(const std::string& name);

/// "actor-published": the 60 frames of its first training and HumanAct12's 5000 epochs; "actor-variable": the 100
/// epochs of fine-tuning after it; "small".
ActorTrainingConfig actor_preset(const std::string& name);
/// "stgcn-published"; "gru-published": the published network, trained as ST-GCN, because its own training is not
/// described anywhere; "small": a GRU.
ClassifierConfig classifier_preset(const std::string& name);

/// "tm2t-published"; "tm2t-published-kit": KIT's; "small": minutes to an hour.
Tm2tTrainingConfig tm2t_preset(const std::string& name, Tm2tStage stage);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/presets.ipp>
#endif
