// SPDX-License-Identifier: MIT
// Bodies of the headers in weights/ that need nlohmann_json, themselves or through others, compiled once.
#include <motionlang/weights/actor_file.ipp>
#include <motionlang/weights/actor_model.ipp>
#include <motionlang/weights/describe_weights.ipp>
#include <motionlang/weights/detail/run_reader.ipp>
#include <motionlang/weights/diffusion_folder.ipp>
#include <motionlang/weights/diffusion_run.ipp>
#include <motionlang/weights/embed_texts.ipp>
#include <motionlang/weights/embedding_cache.ipp>
#include <motionlang/weights/guo_evaluator_file.ipp>
#include <motionlang/weights/mdm_action_run.ipp>
#include <motionlang/weights/model_folder.ipp>
#include <motionlang/weights/model_summary.ipp>
#include <motionlang/weights/pack_run.ipp>
#include <motionlang/weights/run_folder.ipp>
#include <motionlang/weights/text_encoder_folder.ipp>
#include <motionlang/weights/text_motion_checkpoint.ipp>
#include <motionlang/weights/text_motion_file.ipp>
#include <motionlang/weights/text_motion_model.ipp>
#include <motionlang/weights/text_network_file.ipp>
#include <motionlang/weights/text_states.ipp>
#include <motionlang/weights/tm2t_run.ipp>
#include <motionlang/weights/tokenizer_json.ipp>
#include <motionlang/weights/trained_model.ipp>
#include <motionlang/weights/vae_run.ipp>
#include <motionlang/weights/weight_file.ipp>
#include <motionlang/weights/word_vector_source.ipp>
