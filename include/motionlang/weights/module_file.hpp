// SPDX-License-Identifier: MIT
/// Parameters of modules in files of weights: the path of a field is the name of its tensor.
///
///     save_module("model.safetensors", model);
///     load_module(model, "model.safetensors");                          // into a model of the same sizes
///     load_module(model, open_weights("logs/last.ckpt"), "denoiser.");   // any TensorSet (weights/weight_file.hpp)
///
/// Matrices in whole numbers of 8 bits (weights/int8_matrix.hpp) are read like other weights.
#pragma once

#include <algorithm>  // find_if
#include <atomic>     // a finding of several threads
#include <cmath>      // isfinite
#include <cstdint>    // bit patterns
#include <limits>     // infinity
#include <map>        // metadata
#include <optional>   // the type of the module's numbers
#include <set>        // names

#include <motionlang/core/buffer_pool.hpp>
#include <motionlang/core/parallel.hpp>
#include <motionlang/core/standard_library.hpp>
#include <motionlang/file/key_report.hpp>
#include <motionlang/file/safetensors.hpp>
#include <motionlang/tensor/gradient.hpp>
#include <motionlang/tensor/module.hpp>
#include <motionlang/weights/int8_matrix.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The name of a module's tensor in files: its path, unless the module translates (`official_key`).
template <Module M>
std::string tensor_key(const std::string& prefix, const std::string& path) {
  if constexpr (requires { M::official_key(path); })
    return prefix + M::official_key(path);
  else
    return prefix + path;
}

namespace detail {
/// Checks the bits of the exponent, which are all set in NaN and infinity, because compilers vectorise such a loop.
template <Scalar S>
bool all_finite(std::span<const S> numbers) {
  using Bits = std::conditional_t<sizeof(S) == 4, std::uint32_t, std::uint64_t>;
  constexpr Bits exponent = detail::bit_cast<Bits>(std::numeric_limits<S>::infinity());
  std::atomic<bool> finite{true};
  parallel_ranges(std::ssize(numbers), 1, [&](Index first, Index last) {
    Bits wrong = 0;
    for (const S x : numbers.subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(last - first)))
      wrong |= static_cast<Bits>((detail::bit_cast<Bits>(x) & exponent) == exponent);
    if (wrong != 0) finite.store(false, std::memory_order_relaxed);
  });
  return finite;
}
}  // namespace detail

/// Gives a tensor the values of a view, converted to its scalar. float from F32 is a view of the file, without a copy.
/// A variable stays the same variable. NaN is accepted. A matrix in whole numbers of 8 bits needs `scales`
/// (int8_scales_of). Throws io_error 407 for another shape.
template <Backend B>
void assign_tensor(typename B::tensor& tensor, const TensorView& view, const std::shared_ptr<const void>& owner,
                   const std::string& where, const TensorView* scales = nullptr) {
  if constexpr (AutodiffBackend<B>) {
    assign_tensor<typename B::inner>(B::mutable_value(tensor), view, owner, where, scales);
  } else {
    using S = typename B::scalar;
    const Shape shape = B::shape(tensor);
    if (view.shape != shape)
      raise<io_error>(407, where, ": tensor '", view.name, "' is ", view.shape, ", the model has ", shape);
    if constexpr (std::is_constructible_v<typename B::tensor, const S*, Shape, std::shared_ptr<const void>>) {
      const auto numbers = direct<S>(view);
      if (numbers && owner != nullptr && scales == nullptr) {
        tensor = typename B::tensor(numbers->data(), view.shape, owner);
        return;
      }
    }
    tensor = written_tensor<B>(shape, [&](S* to) {
      const std::span<S> values(to, static_cast<std::size_t>(shape.count()));
      if (scales != nullptr)
        copy_int8_values(view, *scales, values);
      else
        copy_values(view, values);
    });
  }
}
/// The purpose of loading a module. For inference, prepare_loaded makes it ready in the same pass over the file: all
/// its matrices are weights, and it is not trained or changed afterwards.
enum class LoadFor { any_use, inference };

namespace detail {

/// Throws numeric_error 301 if a value is NaN or infinite.
template <Scalar S>
void require_finite(std::span<const S> numbers, const TensorView& view, const std::string& where) {
  if (all_finite(numbers)) return;
  const auto wrong = std::find_if(numbers.begin(), numbers.end(), [](auto x) { return !std::isfinite(x); });
  raise<numeric_error>(301, where, ": number ", wrong - numbers.begin(), " of tensor '", view.name, "' is ", *wrong);
}

/// Fills tensors from a file by their names. For inference, their values are checked later.
struct TensorLoader {
  const TensorSet& file;
  const std::string& prefix;
  std::string (*key)(const std::string& prefix, const std::string& path);
  LoadFor use;
  KeyReport& report;
  std::set<std::string>& known;

  template <Backend B>
  void fill(const ModuleTensor<B>& tensor) const {
    const std::string& name = *known.insert(key(prefix, tensor.path)).first;
    const TensorView* view = file.find(name);
    if (view == nullptr) {
      report.missing.push_back(name);
      return;
    }
    assign_tensor<B>(*tensor.data, *view, file.owner(), file.name(), int8_scales_of(file, *view));
    if (use == LoadFor::any_use) require_finite<typename B::scalar>(tensor.span(), *view, file.name());
    MappedFile::forget_if_mapped(view->bytes);  // read again when needed
  }
};

/// True if the tensor repeats one of the module under another name. Throws io_error 407 if it should but differs.
template <class M>
bool is_copy(const M& module, const TensorSet& file, const std::string& prefix, const TensorView& t) {
  if constexpr (requires { module.copy_of(t.name); }) {
    const std::string path = module.copy_of(t.name.substr(prefix.size()));
    const TensorView* original = path.empty() ? nullptr : file.find(prefix + path);
    if (original == nullptr) return false;
    if (values_of<double>(*original) != values_of<double>(t))
      raise<io_error>(407, file.name(), ": tensor '", t.name, "' should repeat '", original->name, "' but differs");
    return true;
  }
  return false;
}

}  // namespace detail

/// Tensors for a file to write, with their own memory.
class TensorStore {
 public:
  /// Copies the values, rounded to `dtype` (F32, F64, F16 or BF16). Throws config_error 101 for another dtype,
  /// numeric_error 301 for a value that would become infinite; for F16 also for NaN and infinity.
  template <Scalar S>
  void add(std::string name, const FileShape& shape, std::span<const S> values, DType dtype) {
    switch (dtype) {
      case DType::F32:
        require_held(name, values, dtype, std::numeric_limits<float>::infinity());
        return put<float>(std::move(name), shape, values, dtype, [](S x) { return static_cast<float>(x); });
      case DType::F64:
        return put<double>(std::move(name), shape, values, dtype, [](S x) { return static_cast<double>(x); });
      case DType::F16:
        require_held(name, values, dtype, 65520);
        return put<std::uint16_t>(std::move(name), shape, values, dtype,
                                  [](S x) { return float_to_half(static_cast<float>(x)); });
      case DType::BF16:
        require_held(name, values, dtype, 0x1.FFp127F);
        return put<std::uint16_t>(std::move(name), shape, values, dtype,
                                  [](S x) { return float_to_bfloat16(static_cast<float>(x)); });
      default:
        raise<config_error>(101, "TensorStore: '", name, "' cannot be stored as ", dtype);
    }
  }
  /// All tensors of a module.
  template <Module M>
  void add_module(const M& module, const std::string& prefix = "", DType dtype = DType::F32) {
    for (const auto& t : tensors_of(module)) add(tensor_key<M>(prefix, t.path), t.shape(), t.span(), dtype);
  }
  std::vector<TensorView> views() const {
    std::vector<TensorView> out;
    for (const Entry& e : entries_) out.push_back({e.name, e.dtype, e.shape, e.bytes});
    return out;
  }

 private:
  struct Entry {
    std::string name;
    DType dtype;
    FileShape shape;
    std::vector<std::byte> bytes;
  };
  /// end   the smallest value that rounds to infinity
  template <Scalar S>
  static void require_held(const std::string& name, std::span<const S> values, DType dtype, float end) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (std::abs(static_cast<float>(values[i])) < end) continue;
      if (std::isfinite(values[i]) || dtype == DType::F16)
        raise<numeric_error>(301, "TensorStore: number ", i, " of '", name, "' is ", values[i], ", too large for ",
                             dtype);
    }
  }
  template <class Stored, Scalar S, class F>
  void put(std::string name, const FileShape& shape, std::span<const S> values, DType dtype, F convert) {
    Entry e{std::move(name), dtype, shape, std::vector<std::byte>(values.size() * sizeof(Stored))};
    for (std::size_t i = 0; i < values.size(); ++i) {
      const Stored v = convert(values[i]);
      std::memcpy(e.bytes.data() + i * sizeof(Stored), &v, sizeof(Stored));
    }
    entries_.push_back(std::move(e));
  }
  std::vector<Entry> entries_;
};

namespace detail {
/// Packs a weight. If it lies in a mapped file, its memory there is released; a later reader loads it from the file
/// again. Returns true if all values are finite.
template <PackingBackend B>
bool pack_loaded(const typename B::tensor& weight) {
  const bool finite = pack_weight<B>(weight);
  MappedFile::forget_if_mapped(std::as_bytes(B::to_span(weight)));
  return finite;
}

/// Moves the values of a converted weight into an unnamed file, if there is a place for one.
template <PackingBackend B>
void put_aside(typename B::tensor& weight) {
  const auto bytes = std::as_bytes(B::to_span(weight));
  if (MappedFile::that_holds(bytes) != nullptr || !weight.unique()) return;
  const auto aside = MappedFile::put_aside(bytes);
  if (aside == nullptr) return;
  const auto* numbers = reinterpret_cast<const typename B::scalar*>(aside->bytes().data());
  weight = typename B::tensor(numbers, B::shape(weight), aside);
  BufferPool::local().trim();  // packed, it may need a larger buffer than the one that it frees
}

/// A small tensor in a mapped file becomes a copy: otherwise the system may keep two megabytes of the file for a bias.
template <Backend B>
void copy_small(typename B::tensor& t) {
  if constexpr (requires { t.attached(); }) {
    constexpr std::size_t small = 1 << 14;
    const auto numbers = B::to_span(t);
    const auto bytes = std::as_bytes(numbers);
    const MappedFile* const file = MappedFile::that_holds(bytes);
    if (file == nullptr || t.attached() != nullptr || numbers.size() >= small) return;
    auto copy = B::from_span(numbers, B::shape(t));
    file->forget(bytes);  // before the tensor, which may be the last owner of the file
    t = std::move(copy);
  }
}

/// Makes a tensor ready; if `looked_at`, returns true if its values are finite.
template <Backend B>
bool prepare_loaded_tensor(const ModuleTensor<B>& t, bool looked_at) {
  bool finite = true;
  if constexpr (PackingBackend<B>) {
    if (has_panels<B>(t.rank)) {
      finite = pack_loaded<B>(*t.data);
      looked_at = false;
    }
  }
  if (looked_at) finite = all_finite(t.span());
  copy_small<B>(*t.data);
  return finite;
}
/// For large networks: a converted weight is moved to a file, so that it is not in memory twice. If it cannot be moved,
/// it is not packed.
template <Backend B>
void prepare_loaded_once(const ModuleTensor<B>& t) {
  if constexpr (PackingBackend<B>) {
    if (has_panels<B>(t.rank)) {
      put_aside<B>(*t.data);
      if (MappedFile::that_holds(std::as_bytes(t.span())) != nullptr) pack_loaded<B>(*t.data);
    }
  }
  copy_small<B>(*t.data);
}
/// Every thread takes some tensors, because new memory is slow to arrive and each thread gets its own. `finite` (null:
/// not checked) becomes false if a value is not finite.
template <Backend B>
void prepare_in_shares(const std::vector<ModuleTensor<B>>& tensors, std::atomic<bool>* finite) {
  const Index count = std::ssize(tensors), shares = parallel_width();
  parallel_for(shares, [&](Index share) {
    for (Index i = 0; i < count; ++i) {
      if (i * shares / count != share) continue;
      const bool good = prepare_loaded_tensor(tensors[static_cast<std::size_t>(i)], finite != nullptr);
      if (finite != nullptr && !good) finite->store(false);
    }
  });
}
}  // namespace detail

/// `prepare` for networks all of whose matrices are weights, straight from a file. The memory of a mapped file is
/// released as soon as a weight is packed, so that none is in memory twice. Small tensors become copies. A later reader
/// of the file loads it from the disk. Converted weights are packed beside their values.
template <Module M>
void prepare_loaded(M& model) {
  detail::prepare_in_shares(tensors_of(model), nullptr);
}

/// Fills all tensors of a module from the tensors whose names begin with `prefix`. The module has its sizes already.
/// Returns the names that did not match (then the module is not made ready). Throws io_error 407 for a tensor of
/// another shape, numeric_error 301 for NaN and infinity. A module may declare (`copy_of`) further names for one of its
/// tensors;
/// io_error 407 if such a tensor differs.
template <Module M>
KeyReport load_module_partly(M& module, const TensorSet& file, const std::string& prefix = "",
                             LoadFor use = LoadFor::any_use) {
  const auto tensors = tensors_of(module);
  KeyReport report;
  std::set<std::string> known;
  const auto fill = [&](LoadFor how) {
    report = {};
    known.clear();
    const detail::TensorLoader loader{file, prefix, &tensor_key<M>, how, report, known};
    for (const auto& t : tensors) loader.fill(t);
  };
  fill(use);
  if (use == LoadFor::inference) {
    std::atomic<bool> finite{report.missing.empty()};
    if (finite) detail::prepare_in_shares(tensors, &finite);
    if (!finite) fill(LoadFor::any_use);  // reports which value is not finite
  }
  for (const TensorView& t : file.tensors()) {
    if (!t.name.starts_with(prefix) || known.contains(t.name) || is_int8_scales(file, t)) continue;
    if (!detail::is_copy(module, file, prefix, t)) report.unexpected.push_back(t.name);
  }
  return report;
}
/// The same, but every name must match. Throws io_error 406 with both lists and with similar names.
template <Module M>
void load_module(M& module, const TensorSet& file, const std::string& prefix = "", LoadFor use = LoadFor::any_use) {
  const KeyReport report = load_module_partly(module, file, prefix, use);
  if (report.missing.empty() && report.unexpected.empty()) return;
  detail::raise_key_mismatch(file.name(), report);
}
/// The same from a safetensors file, as save_module writes it.
template <Module M>
void load_module(M& module, const FilePath& path, LoadFor use = LoadFor::any_use) {
  load_module(module, SafetensorsFile::open(path), "", use);
}

/// Writes all tensors of a module into a safetensors file, without its sizes and options: the caller makes the module,
/// and load_module fills it. `dtype` is that of the module's values unless given. Throws io_error 401, and what
/// TensorStore::add throws.
template <Module M>
void save_module(const FilePath& path, const M& module, std::optional<DType> dtype = {},
                 const std::map<std::string, std::string>& metadata = {{"format", "pt"}}) {
  constexpr bool is_double = std::is_same_v<typename module_backend<M>::scalar, double>;
  TensorStore store;
  store.add_module(module, "", dtype.value_or(is_double ? DType::F64 : DType::F32));
  write_safetensors(path, store.views(), metadata);
}

MOTIONLANG_NAMESPACE_END
