// SPDX-License-Identifier: MIT
/// Helpers for readers of official run folders: options and shapes of tensors compared, statistics of features.
#pragma once

#include <filesystem>  // folders

#include <motionlang/features/normalizer.hpp>
#include <motionlang/weights/module_file.hpp>
#include <motionlang/weights/text_network_file.hpp>
#include <motionlang/weights/weight_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The parent of a folder, also for "a/b/" and ".".
std::filesystem::path folder_around(const std::filesystem::path& folder);

/// Options of a run and shapes of its tensors, compared.
class RunReader {
 public:
  RunReader(const RunFolder& run, const TensorSet& weights, std::string prefix)
      : run_(&run), weights_(&weights), prefix_(std::move(prefix)) {}

  const std::string& prefix() const { return prefix_; }
  bool has(const std::string& name) const { return weights_->find(prefix_ + name) != nullptr; }
  /// Size of a tensor along an axis. Throws io_error 407 if it has no such axis or no numbers.
  Index size(const std::string& name, int axis) const;
  /// The same for a size that options may state.
  Index size(const std::string& name, int axis, std::initializer_list<const char*> options) const;
  /// The same for a tensor that may be missing: then an option must state the size 0.
  Index size_if_any(const std::string& name, int axis, std::initializer_list<const char*> options) const;
  /// The number of tensors with a numbered name, "layers.#.weight".
  Index count(const std::string& before, const std::string& behind, std::initializer_list<const char*> options) const;

  /// The first option that exists among several names. Throws config_error 101 unless it is smallest ... largest.
  Index number(std::initializer_list<const char*> keys, Index otherwise, Index largest, Index smallest = 1) const;
  double real(const char* key, double otherwise) const;
  bool flag(const char* key, bool otherwise) const;
  std::string text(const char* key, const char* otherwise) const;
  std::string one_of(const char* key, const char* otherwise, std::initializer_list<std::string_view> known) const;
  std::string place(const char* key) const { return concat_text(run_->options_file.string(), ": ", key); }

 private:
  std::optional<Index> whole(const char* key) const;
  [[noreturn]] void wrong_kind(const char* key, const char* wanted, const FileValue& v) const;

  const RunFolder* run_;
  const TensorSet* weights_;
  std::string prefix_;
};

RunReader reader_of(const RunFolder& run, const TensorSet& weights, std::string_view name);

/// Mean and std after the first prefix that has both; null if none has them.
struct Statistics {
  const TensorView *mean = nullptr, *std = nullptr;
};
/// Throws io_error 407 for another width.
Statistics find_statistics(const TensorSet& file, Index width, std::initializer_list<const char*> prefixes);
template <Backend B>
std::optional<Normalizer<B>> find_normalizer(const TensorSet& file, Index width,
                                             std::initializer_list<const char*> prefixes) {
  const Statistics found = find_statistics(file, width, prefixes);
  if (found.mean == nullptr) return std::nullopt;
  using S = typename B::scalar;
  Normalizer<B> out = Normalizer<B>::identity(width);
  out.mean = Tensor<B, 1>::from(values_of<S>(*found.mean), {width});
  out.std = Tensor<B, 1>::from(values_of<S>(*found.std), {width});
  return out;
}

/// The files with the statistics of a folder.
WeightFile statistics_of(const RunFolder& run);

[[noreturn]] void raise_no_statistics(const RunFolder& folder, std::string_view missing);

/// Mean and std of a folder. `missing` ends the message "no statistics of ...". Throws io_error 401, 407.
template <Backend B>
Normalizer<B> folder_normalizer(const RunFolder& folder, Index width, std::initializer_list<const char*> prefixes,
                                std::string_view missing) {
  if (!folder.parts.empty()) {
    if (auto found = find_normalizer<B>(statistics_of(folder), width, prefixes)) return *std::move(found);
  }
  raise_no_statistics(folder, missing);
}
/// The statistics of the motions: from the folder `elsewhere` if one is named, else from packed weights, else from the
/// run.
template <Backend B>
Normalizer<B> run_normalizer(const RunFolder& run, const TensorSet& weights, Index width,
                             std::initializer_list<const char*> prefixes, std::string_view missing,
                             const FilePath& elsewhere = "") {
  if (!elsewhere.string().empty()) return folder_normalizer<B>(find_run(elsewhere), width, prefixes, missing);
  if (auto packed = find_normalizer<B>(weights, width, {"motion_normalizer."})) return *std::move(packed);
  return folder_normalizer<B>(run, width, prefixes, missing);
}

/// Fills a module. `beside(name)`: true for further tensors that the file may hold.
template <Module M, class F>
void load_run_module(M& module, const TensorSet& file, const std::string& prefix, F beside,
                     LoadFor use = LoadFor::any_use) {
  KeyReport report = load_module_partly(module, file, prefix, use);
  std::erase_if(report.unexpected, beside);
  if (!report.missing.empty() || !report.unexpected.empty()) raise_key_mismatch(file.name(), report);
}

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/detail/run_reader.ipp>
#endif
