// Shows files of weights of every kind, and converts them to safetensors.
#include "weights.hpp"

#include <algorithm>
#include <cstdio>

#include <motionlang/file/npz.hpp>
#include <motionlang/formats/amass_sequence.hpp>
#include <motionlang/weights/model_summary.hpp>
#include <motionlang/weights/safetensors_copy.hpp>
#include <motionlang/weights/weight_file.hpp>

#include "motion_files.hpp"

namespace program {

namespace {

std::string summary(const ml::WeightFile& file) {
  ml::Index numbers = 0;
  std::size_t bytes = 0;
  for (const auto& t : file.tensors()) {
    numbers += t.shape.count();
    bytes += t.bytes.size();
  }
  char megabytes[32];
  std::snprintf(megabytes, sizeof megabytes, "%.1f MB", static_cast<double>(bytes) * 1e-6);
  return ml::concat_text(ml::counted(file.tensors().size(), "tensor"), ", ", ml::counted(numbers, "number"), ", ",
                         megabytes, ", ", file.format());
}

void show_skipped(const ml::WeightFile& file) {
  for (const ml::SkippedValue& v : file.skipped()) std::printf("  skipped: %s\n", ml::printable(to_string(v)).c_str());
}

}  // namespace

bool is_weights(const std::filesystem::path& path) {
  constexpr std::string_view kinds[] = {".safetensors", ".pt", ".pth", ".ckpt", ".tar", ".bin", ".pkl"};
  return std::find(std::begin(kinds), std::end(kinds), kind_of(path)) != std::end(kinds) || ml::may_be_weights(path);
}
bool holds_motion(const std::filesystem::path& npz) { return !ml::amass_poses(ml::NpzArchive::open(npz)).empty(); }
bool holds_joints(const std::filesystem::path& npy) {
  const auto shape = npy_shape(npy);
  return shape.size() == 3 && shape.back() == 3;
}

void show_weights(const std::filesystem::path& path) {
  const auto file = ml::open_weights(path);
  std::printf("%s: %s\n", path.string().c_str(), summary(file).c_str());
  if (std::filesystem::is_directory(path)) std::printf("%s", ml::printable(ml::describe_folder(path), "\n").c_str());
  for (const ml::FileValue& v : file.values()) {
    const std::string text = to_string(v);
    const auto lines = std::count(text.begin(), text.end(), '\n') + 1;
    if (lines > 1)
      std::printf("  %-24s (%td lines)\n", ml::printable(v.path).c_str(), lines);
    else
      std::printf("  %-24s %s\n", ml::printable(v.path).c_str(), ml::printable(text).c_str());
  }
  for (const auto& t : file.tensors())
    std::printf("  %-60s %-5s %s\n", ml::printable(t.name).c_str(), to_string(t.dtype).c_str(),
                to_string(t.shape).c_str());
  show_skipped(file);
}

void convert_weights(const std::filesystem::path& in, const std::filesystem::path& out, const std::string& keys,
                     std::optional<ml::DType> stored) {
  ml::WeightOptions options;
  if (!keys.empty()) options.path = keys;
  const auto file = ml::open_weights(in, options);
  ml::InputFiles(file.files()).refuse(out);
  ml::write_safetensors_copy(out, file, stored);
  std::printf("%s: %s\n", out.string().c_str(), summary(ml::open_weights(out)).c_str());
  show_skipped(file);
}

}  // namespace program
