// SPDX-License-Identifier: MIT
// Bodies of describe_weights.hpp.
#pragma once

#include <algorithm>   // count, find
#include <filesystem>  // folders

#include <motionlang/core/formatted.hpp>
#include <motionlang/core/utf8.hpp>
#include <motionlang/formats/motion_file.hpp>
#include <motionlang/weights/describe_weights.hpp>
#include <motionlang/weights/model_summary.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY bool holds_weights(const FilePath& path) {
  constexpr std::string_view kinds[] = {".safetensors", ".pt", ".pth", ".ckpt", ".tar", ".bin", ".pkl"};
  return std::find(std::begin(kinds), std::end(kinds), file_kind(path)) != std::end(kinds) || may_be_weights(path);
}

MOTIONLANG_BODY std::string line_about_weights(const WeightFile& weights) {
  Index numbers = 0;
  std::size_t bytes = 0;
  for (const TensorView& t : weights.tensors()) {
    numbers += t.shape.count();
    bytes += t.bytes.size();
  }
  return concat_text(counted(weights.tensors().size(), "tensor"), ", ", counted(numbers, "number"), ", ",
                     formatted("%.1f MB", static_cast<double>(bytes) * 1e-6), ", ", weights.format());
}

MOTIONLANG_BODY std::string lines_about_skipped(const WeightFile& weights) {
  std::string out;
  for (const SkippedValue& v : weights.skipped()) out += "  skipped: " + printable(to_string(v)) + "\n";
  return out;
}

MOTIONLANG_BODY std::string describe_weights(const FilePath& path) {
  const WeightFile weights = open_weights(path);
  std::string out = path.string() + ": " + line_about_weights(weights) + "\n";
  if (std::filesystem::is_directory(path.string())) out += printable(describe_folder(path), "\n");
  for (const FileValue& v : weights.values()) {
    const std::string text = to_string(v), name = printable(v.path);
    const auto lines = std::count(text.begin(), text.end(), '\n') + 1;
    out += lines > 1 ? formatted("  %-24s (%td lines)\n", name.c_str(), lines)
                     : formatted("  %-24s %s\n", name.c_str(), printable(text).c_str());
  }
  for (const TensorView& t : weights.tensors())
    out += formatted("  %-60s %-5s %s\n", printable(t.name).c_str(), to_string(t.dtype).c_str(),
                     to_string(t.shape).c_str());
  return out + lines_about_skipped(weights);
}

MOTIONLANG_NAMESPACE_END
