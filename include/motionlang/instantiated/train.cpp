// SPDX-License-Identifier: MIT
// Bodies of the headers in train/, compiled once for motionlang::instantiated.
#include <motionlang/train/batch_parts.ipp>
#include <motionlang/train/learned_captions.ipp>
#include <motionlang/train/part_threads.ipp>
#include <motionlang/train/remembered_motions.ipp>
#include <motionlang/train/stmc_start.ipp>
#include <motionlang/train/stmc_training.ipp>
#include <motionlang/train/stmc_training_config.ipp>
#include <motionlang/train/stmc_training_notes.ipp>
#include <motionlang/train/training_record.ipp>
