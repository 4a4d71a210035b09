// SPDX-License-Identifier: MIT
// Bodies of torch_archive.hpp.
#pragma once

#include <limits>  // sizes

#include <motionlang/file/torch_archive.hpp>
#include <motionlang/file/zip.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY void TorchArchive::begin(std::string_view key) {
  put_text(key);
  pickle_ += '}';
}

MOTIONLANG_BODY void TorchArchive::number(std::string_view key, std::int32_t value) {
  put_text(key);
  put_integer(value);
  pickle_ += 's';
}

MOTIONLANG_BODY void TorchArchive::text(std::string_view key, std::string_view value) {
  put_text(key);
  put_text(value);
  pickle_ += 's';
}

MOTIONLANG_BODY void TorchArchive::tensor(std::string_view key, const TensorView& view) {
  put_text(key);
  put_tensor(view);
  pickle_ += 's';
}

MOTIONLANG_BODY std::vector<std::byte> TorchArchive::finish() {
  pickle_ += '.';
  return archive();
}

MOTIONLANG_BODY std::vector<std::byte> TorchArchive::of_tensor(const TensorView& view) {
  TorchArchive out;
  out.pickle_ = "\x80\x02";
  out.put_tensor(view);
  return out.finish();
}

MOTIONLANG_BODY std::vector<std::byte> TorchArchive::archive() const {
  ZipWriter zip;
  zip.add("archive/data.pkl", std::as_bytes(std::span(pickle_)));
  for (std::size_t i = 0; i < storages_.size(); ++i) zip.add("archive/data/" + std::to_string(i), storages_[i]);
  zip.add("archive/version", std::as_bytes(std::span("3\n", 2)));
  return zip.finish();
}

MOTIONLANG_BODY void TorchArchive::put_integer(std::int32_t value) {
  const auto n = static_cast<std::uint32_t>(value);
  pickle_ += 'J';
  for (int shift = 0; shift < 32; shift += 8) pickle_ += static_cast<char>(n >> shift & 0xff);
}

MOTIONLANG_BODY void TorchArchive::put_text(std::string_view value) {
  const auto n = static_cast<std::uint32_t>(value.size());
  pickle_ += 'X';
  for (int shift = 0; shift < 32; shift += 8) pickle_ += static_cast<char>(n >> shift & 0xff);
  pickle_ += value;
}

MOTIONLANG_BODY void TorchArchive::put_tensor(const TensorView& view) {
  const char* type = view.dtype == DType::F32   ? "FloatStorage"
                     : view.dtype == DType::F64 ? "DoubleStorage"
                     : view.dtype == DType::F16 ? "HalfStorage"
                                                : nullptr;
  if (type == nullptr) raise<config_error>(101, "TorchArchive: '", view.name, "' of type ", to_string(view.dtype));
  const auto put_size = [&](Index size) {
    constexpr Index largest = std::numeric_limits<std::int32_t>::max();
    if (size > largest)
      raise<config_error>(101, "TorchArchive: '", view.name, "' has the size ", size, ", above ", largest);
    put_integer(static_cast<std::int32_t>(size));
  };
  pickle_ += "ctorch._utils\n_rebuild_tensor_v2\n((";
  put_text("storage");
  pickle_.append("ctorch\n").append(type).append("\n");
  put_text(std::to_string(storages_.size()));
  put_text("cpu");
  put_size(view.shape.count());
  pickle_ += "tQ";
  put_integer(0);
  pickle_ += '(';
  for (int axis = 0; axis < view.shape.rank(); ++axis) put_size(view.shape[axis]);
  pickle_ += "t(";
  for (int axis = 0; axis < view.shape.rank(); ++axis) {
    Index stride = 1;
    for (int k = axis + 1; k < view.shape.rank(); ++k) stride *= view.shape[k];
    put_size(stride);
  }
  pickle_ +=
      "t\x89"
      "ccollections\nOrderedDict\n)RtR";
  storages_.emplace_back(view.bytes.begin(), view.bytes.end());
}

MOTIONLANG_NAMESPACE_END
