// SPDX-License-Identifier: MIT
// Bodies of the headers in train/ that need nlohmann_json, compiled once for motionlang::instantiated.
#include <motionlang/train/action_batch.ipp>
#include <motionlang/train/actor_training.ipp>
#include <motionlang/train/classifier_training.ipp>
#include <motionlang/train/diffusion_items.ipp>
#include <motionlang/train/diffusion_presets.ipp>
#include <motionlang/train/diffusion_systems.ipp>
#include <motionlang/train/diffusion_texts.ipp>
#include <motionlang/train/diffusion_training.ipp>
#include <motionlang/train/epoch_task.ipp>
#include <motionlang/train/guo_evaluation.ipp>
#include <motionlang/train/mdm_action_training.ipp>
#include <motionlang/train/measured_items.ipp>
#include <motionlang/train/measured_similarity.ipp>
#include <motionlang/train/moment_evaluation.ipp>
#include <motionlang/train/mtt_evaluation.ipp>
#include <motionlang/train/presets.ipp>
#include <motionlang/train/recognition.ipp>
#include <motionlang/train/retrieval_evaluation.ipp>
#include <motionlang/train/sinc_training.ipp>
#include <motionlang/train/temos_evaluation.ipp>
#include <motionlang/train/temos_training.ipp>
#include <motionlang/train/text_entries.ipp>
#include <motionlang/train/text_motion_texts.ipp>
#include <motionlang/train/tm2t_tokenizer_training.ipp>
#include <motionlang/train/tm2t_tokens.ipp>
#include <motionlang/train/tmr_training.ipp>
