// Shows files of weights in any format, and writes them as safetensors.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <motionlang/core/utf8.hpp>
#include <motionlang/file/tensor_view.hpp>

namespace program {

namespace ml = motionlang;

/// True if a file or folder holds weights. Its extension decides if it is a known one, else its first bytes.
bool is_weights(const std::filesystem::path& path);
/// True if a NumPy file holds a motion or joint positions rather than weights.
bool holds_motion(const std::filesystem::path& npz);
bool holds_joints(const std::filesystem::path& npy);

void show_weights(const std::filesystem::path& path);
/// `keys` lead to the tensors in the file; by default they are searched. Floating-point values are rounded to `stored`,
/// if given.
void convert_weights(const std::filesystem::path& in, const std::filesystem::path& out, const std::string& keys,
                     std::optional<ml::DType> stored);

}  // namespace program
