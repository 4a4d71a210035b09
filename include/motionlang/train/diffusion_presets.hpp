// SPDX-License-Identifier: MIT
/// Hyperparameters of MDM-SMPL, MDM and MotionDiffuse by name: "...-published" is what the published programs use, and
/// "...-paper" what a paper says where it differs. "small" trains in minutes on two cores, without a language model.
///
///     MdmSmplTrainingConfig config = mdm_smpl_preset("small");
///     set_config(config, "optimiser.epochs=20");
///
/// Source   the options of the published repositories, which EQUATIONS.md lists
/// Throws   config_error 103 for an unknown name, with the known ones
#pragma once

#include <string>  // names

#include <motionlang/weights/diffusion_training_config.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// "mdm-smpl-published"; "mdm-smpl-paper": Chen's schedule as thesis 6.2.4 says, and the sizes of MDM, whose
/// architecture it says to have; "small".
MdmSmplTrainingConfig mdm_smpl_preset(const std::string& name);

/// "mdm-published": the model of the paper, of 1000 steps; "mdm-published-kit"; "mdm50-published": 50 steps, masked
/// frames, averaged weights; "mdm50-published-bert": the same with DistilBERT and the decoder; "small".
MdmTrainingConfig mdm_preset(const std::string& name);

/// "motiondiffuse-published": the command of the repository for one GPU; "motiondiffuse-paper": the published run on
/// eight, whose batches together are one of 1024; "small".
MotionDiffuseTrainingConfig motiondiffuse_preset(const std::string& name);

/// "mdm-actions-published": HumanAct12 and UESTC; "small".
MdmActionTrainingConfig mdm_action_preset(const std::string& name);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/diffusion_presets.ipp>
#endif
