// SPDX-License-Identifier: MIT
/// Writes files as torch.save does: a zip archive with the pickle of dictionaries, numbers, texts and tensors.
///
///     TorchArchive archive;
///     archive.begin("text_encoder");                 // a dictionary inside
///     for (const TensorView& t : store.views()) archive.tensor(t.name, t);
///     archive.end();
///     archive.number("epoch", 3);
///     write_file("finest.tar", archive.finish());
///
/// torch.load reads it, also with weights_only=True: the pickle names nothing but torch's own tensors.
/// Source  pytorch/pytorch torch/serialization.py (_save) and torch/_utils.py (_rebuild_tensor_v2)
#pragma once

#include <cstdint>      // numbers
#include <string>       // the pickle
#include <string_view>  // keys
#include <vector>       // storages

#include <motionlang/file/tensor_view.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Entries are added in order; `begin` opens a dictionary inside, `end` closes it.
class TorchArchive {
 public:
  TorchArchive() : pickle_("\x80\x02}") {}

  void begin(std::string_view key);
  void end() { pickle_ += 's'; }
  void number(std::string_view key, std::int32_t value);
  void text(std::string_view key, std::string_view value);
  /// Throws config_error 101 for another type than F16, F32 and F64, and for a size above 2^31 - 1.
  void tensor(std::string_view key, const TensorView& view);
  /// The whole file. Throws io_error 405 if it would need ZIP64.
  std::vector<std::byte> finish();

  /// A tensor that is the whole file, as the statistics of TMR and STMC are.
  static std::vector<std::byte> of_tensor(const TensorView& view);

 private:
  std::vector<std::byte> archive() const;
  void put_integer(std::int32_t value);
  void put_text(std::string_view value);
  void put_tensor(const TensorView& view);

  std::string pickle_;
  std::vector<std::vector<std::byte>> storages_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/torch_archive.ipp>
#endif
