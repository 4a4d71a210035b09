// SPDX-License-Identifier: MIT
/// Writes files as torch.save does: a zip archive with the pickle of dictionaries, numbers, texts and tensors.
#pragma once

#include <motionlang/file/tensor_view.hpp>
#include <motionlang/file/zip.hpp>

/// Entries are added in order; `begin` opens a dictionary inside, `end` closes it.
class TorchArchive {
 public:
  TorchArchive() : pickle_("\x80\x02}") {}

  void begin(std::string_view key) {
    text(key);
    pickle_ += '}';
  }
  void end() { pickle_ += 's'; }
  void number(std::string_view key, std::int32_t value) {
    text(key);
    integer(value);
    pickle_ += 's';
  }
  void tensor(std::string_view key, const motionlang::TensorView& view) {
    text(key);
    put_tensor(view);
    pickle_ += 's';
  }
  std::vector<std::byte> finish() {
    pickle_ += '.';
    return archive();
  }
  /// A tensor that is the whole file, as the statistics of TMR and STMC are.
  static std::vector<std::byte> of_tensor(const motionlang::TensorView& view) {
    TorchArchive out;
    out.pickle_ = "\x80\x02";
    out.put_tensor(view);
    return out.finish();
  }

 private:
  std::vector<std::byte> archive() {
    motionlang::ZipWriter zip;
    zip.add("archive/data.pkl", std::as_bytes(std::span(pickle_)));
    for (std::size_t i = 0; i < storages_.size(); ++i) zip.add("archive/data/" + std::to_string(i), storages_[i]);
    zip.add("archive/version", std::as_bytes(std::span("3\n", 2)));
    return zip.finish();
  }
  void integer(std::int64_t value) {
    const auto n = static_cast<std::int32_t>(value);
    pickle_.append("J").append(reinterpret_cast<const char*>(&n), sizeof n);
  }
  void text(std::string_view value) {
    const auto n = static_cast<std::uint32_t>(value.size());
    pickle_.append("X").append(reinterpret_cast<const char*>(&n), sizeof n).append(value);
  }
  void put_tensor(const motionlang::TensorView& view) {
    const char* type = view.dtype == motionlang::DType::F32   ? "FloatStorage"
                       : view.dtype == motionlang::DType::F64 ? "DoubleStorage"
                                                              : "HalfStorage";
    pickle_ += "ctorch._utils\n_rebuild_tensor_v2\n((";
    text("storage");
    pickle_.append("ctorch\n").append(type).append("\n");
    text(std::to_string(storages_.size()));
    text("cpu");
    integer(view.shape.count());
    pickle_ += "tQ";
    integer(0);
    pickle_ += '(';
    for (int axis = 0; axis < view.shape.rank(); ++axis) integer(view.shape[axis]);
    pickle_ += "t(";
    for (int axis = 0; axis < view.shape.rank(); ++axis) {
      motionlang::Index stride = 1;
      for (int k = axis + 1; k < view.shape.rank(); ++k) stride *= view.shape[k];
      integer(stride);
    }
    pickle_ +=
        "t\x89"
        "ccollections\nOrderedDict\n)RtR";
    storages_.emplace_back(view.bytes.begin(), view.bytes.end());
  }

  std::string pickle_;
  std::vector<std::vector<std::byte>> storages_;
};
