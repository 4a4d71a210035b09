// SPDX-License-Identifier: MIT
// Bodies of the headers in weights/ that need nlohmann_json, compiled once for motionlang::instantiated.
#include <motionlang/weights/diffusion_folder.ipp>
#include <motionlang/weights/embedding_cache.ipp>
#include <motionlang/weights/model_folder.ipp>
#include <motionlang/weights/pack_run.ipp>
#include <motionlang/weights/text_encoder_folder.ipp>
#include <motionlang/weights/text_network_file.ipp>
#include <motionlang/weights/tokenizer_json.ipp>
#include <motionlang/weights/weight_file.ipp>
