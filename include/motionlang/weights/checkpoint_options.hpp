// SPDX-License-Identifier: MIT
/// Files that a model reads and that are not in its folder: options of load_stmc, load_tmr, load_temos, load_teach and
/// load_sinc.
#pragma once

#include <motionlang/file/file_path.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Where a model finds what its folder lacks.
struct CheckpointOptions {
  /// Folder or file of the language model that the network reads (DistilBERT, CLIP). For TMR, TEMOS, TEACH and SINC
  /// also the .npy file of a cache of its states. Unless given, a published model other than TMR looks beside itself.
  /// Models with word pieces of their own need none.
  FilePath text_encoder = "";
  /// Folder with mean and std of the features of a published model, .pt or .npy, if they are not beside it.
  FilePath statistics = "";
};

MOTIONLANG_NAMESPACE_END
