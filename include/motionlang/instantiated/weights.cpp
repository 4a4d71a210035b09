// SPDX-License-Identifier: MIT
// Bodies of the headers in weights/, compiled once for motionlang::instantiated.
#include <motionlang/weights/actor_file.ipp>
#include <motionlang/weights/detail/run_reader.ipp>
#include <motionlang/weights/diffusion_run.ipp>
#include <motionlang/weights/glove_file.ipp>
#include <motionlang/weights/guo_evaluator_file.ipp>
#include <motionlang/weights/mdm_action_run.ipp>
#include <motionlang/weights/run_folder.ipp>
#include <motionlang/weights/stmc_file.ipp>
#include <motionlang/weights/stmc_record.ipp>
#include <motionlang/weights/text_motion_file.ipp>
#include <motionlang/weights/tm2t_run.ipp>
#include <motionlang/weights/tokenizer_files.ipp>
#include <motionlang/weights/vae_run.ipp>
