// SPDX-License-Identifier: MIT
// Bodies of the headers in weights/, compiled once for motionlang::instantiated.
#include <motionlang/weights/caption_encoder_file.ipp>
#include <motionlang/weights/glove_file.ipp>
#include <motionlang/weights/int8_matrix.ipp>
#include <motionlang/weights/known_caption_file.ipp>
#include <motionlang/weights/known_systems.ipp>
#include <motionlang/weights/safetensors_copy.ipp>
#include <motionlang/weights/stmc_file.ipp>
#include <motionlang/weights/stmc_record.ipp>
#include <motionlang/weights/tokenizer_files.ipp>
#include <motionlang/weights/word_vector_file.ipp>
