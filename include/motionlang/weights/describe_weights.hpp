// SPDX-License-Identifier: MIT
/// A file or folder of weights as text: its format, its other values, its tensors, and what was skipped.
#pragma once

#include <string>  // lines

#include <motionlang/weights/weight_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// True if a file or folder holds weights. Its extension decides if it is a known one, else its first bytes.
bool holds_weights(const FilePath& path);

/// "12 tensors, 3456 numbers, 0.1 MB, safetensors"
std::string line_about_weights(const WeightFile& weights);
/// A line for each value that was skipped.
std::string lines_about_skipped(const WeightFile& weights);

/// All about a file or folder, with the system of a folder. Throws what open_weights and describe_folder throw.
std::string describe_weights(const FilePath& path);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/describe_weights.ipp>
#endif
