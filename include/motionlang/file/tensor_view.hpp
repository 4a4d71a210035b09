// SPDX-License-Identifier: MIT
/// A tensor as stored in a file: name, element type, shape, bytes. Every reader of arrays returns these, and every
/// writer takes them. Nothing is converted before somebody asks for values.
#pragma once

#include <array>             // table of element types
#include <bit>               // bit_width
#include <concepts>          // integral, floating_point
#include <cstddef>           // byte
#include <cstdint>           // element types
#include <cstring>           // memcpy: elements may be unaligned
#include <initializer_list>  // sizes
#include <optional>          // unknown names, direct views
#include <span>              // bytes
#include <string>            // names
#include <string_view>       // names of element types
#include <utility>           // in_range
#include <vector>            // converted values

#include <motionlang/core/half.hpp>
#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

// clang-format off
/// Element types of safetensors files. Values of types up to F64 can be read. For the others only the size is known.
enum class DType : std::uint8_t {
  BOOL, U8, I8, U16, I16, U32, I32, U64, I64, F16, BF16, F32, F64,
  F8_E5M2, F8_E4M3, F8_E8M0, F8_E4M3FNUZ, F8_E5M2FNUZ, F4, F6_E2M3, F6_E3M2, C64
};

struct DTypeInfo {
  std::string_view name;
  int bits;
};
inline constexpr std::array<DTypeInfo, 22> dtype_table{{
    {"BOOL", 8}, {"U8", 8}, {"I8", 8}, {"U16", 16}, {"I16", 16}, {"U32", 32}, {"I32", 32}, {"U64", 64}, {"I64", 64},
    {"F16", 16}, {"BF16", 16}, {"F32", 32}, {"F64", 64},
    {"F8_E5M2", 8}, {"F8_E4M3", 8}, {"F8_E8M0", 8}, {"F8_E4M3FNUZ", 8}, {"F8_E5M2FNUZ", 8},
    {"F4", 4}, {"F6_E2M3", 6}, {"F6_E3M2", 6}, {"C64", 64}}};
// clang-format on

constexpr const DTypeInfo& info(DType t) { return dtype_table[static_cast<std::size_t>(t)]; }
std::string to_string(DType t);
constexpr std::optional<DType> parse_dtype(std::string_view name) {
  for (std::size_t i = 0; i < dtype_table.size(); ++i) {
    if (dtype_table[i].name == name) return static_cast<DType>(i);
  }
  return std::nullopt;
}
/// True if values of this type are whole numbers.
constexpr bool is_integer(DType t) { return t <= DType::I64; }

/// The element type for a C++ number.
template <class T>
requires std::integral<T> || std::floating_point<T>
consteval DType dtype_of() {
  if constexpr (std::same_as<T, bool>) return DType::BOOL;
  if constexpr (std::floating_point<T>) return sizeof(T) == 4 ? DType::F32 : DType::F64;
  constexpr std::array table{DType::U8, DType::U16, DType::U32, DType::U64};
  constexpr auto size = static_cast<unsigned>(std::bit_width(sizeof(T)) - 1);
  return static_cast<DType>(static_cast<unsigned>(table[size]) + (std::signed_integral<T> ? 1u : 0u));
}

/// Sizes of an array in a file, slowest axis first: as many as NumPy and PyTorch allow. A Shape, for calculations, has
/// at most six.
class FileShape {
 public:
  static constexpr int max_rank = 64;

  FileShape() = default;
  FileShape(const Shape& shape);
  FileShape(std::initializer_list<Index> sizes) : FileShape(std::span<const Index>(sizes.begin(), sizes.size())) {}
  explicit FileShape(std::span<const Index> sizes);
  /// Throws shape_error 206 for more than six.
  operator Shape() const { return Shape(std::span<const Index>(sizes_)); }

  int rank() const { return static_cast<int>(sizes_.size()); }
  Index operator[](int axis) const { return sizes_[static_cast<std::size_t>(axis)]; }
  Index& operator[](int axis) { return sizes_[static_cast<std::size_t>(axis)]; }
  std::span<const Index> sizes() const { return sizes_; }
  /// Number of elements.
  Index count() const;
  /// Throws shape_error 205 for a negative size, 206 for more than 64 of them.
  void push_back(Index n);
  friend bool operator==(const FileShape&, const FileShape&) = default;
  friend bool operator==(const FileShape& a, const Shape& b) { return a == FileShape(b); }

 private:
  std::vector<Index> sizes_;
};

/// "(2, 60, 512)"
std::string to_string(const FileShape& s);

/// Row-major, without strides. Does not own its bytes.
struct TensorView {
  std::string name;
  DType dtype = DType::F32;
  FileShape shape;
  std::span<const std::byte> bytes;
};

/// A view of values in memory, for writing.
template <class T>
TensorView tensor_view(std::string name, const FileShape& shape, std::span<const T> values) {
  if (static_cast<std::size_t>(shape.count()) != values.size()) {
    raise<shape_error>(205, "tensor_view: ", counted(values.size(), "value"), " for '", name, "' of shape ", shape);
  }
  return {std::move(name), dtype_of<T>(), shape, std::as_bytes(values)};
}

/// The values themselves, without a copy, if the view holds aligned Ts.
template <class T>
std::optional<std::span<const T>> direct(const TensorView& view) {
  if (view.dtype != dtype_of<T>() || reinterpret_cast<std::uintptr_t>(view.bytes.data()) % alignof(T) != 0) {
    return std::nullopt;
  }
  return std::span(reinterpret_cast<const T*>(view.bytes.data()), view.bytes.size() / sizeof(T));
}

namespace detail {

template <class Stored, class T, class Decode>
void convert(const TensorView& view, std::span<T> out, Decode decode) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    Stored s;
    std::memcpy(&s, view.bytes.data() + i * sizeof(Stored), sizeof(Stored));
    out[i] = decode(s);
  }
}

template <class Stored, class T>
void convert_numbers(const TensorView& view, std::span<T> out) {
  convert<Stored>(view, out, [&](Stored s) {
    if constexpr (std::integral<Stored> && std::integral<T>) {
      if (!std::in_range<T>(s)) {
        raise<io_error>(407, "tensor '", view.name, "': ", s, " does not fit into the requested integer type");
      }
    }
    return static_cast<T>(s);
  });
}

}  // namespace detail

/// Copies all values, converted to T. Numbers of every kind become float or double; only whole numbers become integers.
/// Throws shape_error 205 if the sizes differ, io_error 404 for an unreadable element type, and 407 if the values are
/// of another kind than T or do not fit.
template <class T>
void copy_values(const TensorView& view, std::span<T> out) {
  if (view.bytes.size() * 8 != out.size() * static_cast<std::size_t>(info(view.dtype).bits)) {
    raise<shape_error>(205, "tensor '", view.name, "' of shape ", view.shape, " does not have ",
                       counted(out.size(), "value"));
  }
  if constexpr (std::integral<T>) {
    if (!is_integer(view.dtype)) {
      raise<io_error>(407, "tensor '", view.name, "' holds ", view.dtype, ", not whole numbers");
    }
  }
  switch (view.dtype) {
    case DType::BOOL:
      return detail::convert<std::uint8_t>(view, out, [](std::uint8_t b) { return static_cast<T>(b != 0); });
    case DType::U8:
      return detail::convert_numbers<std::uint8_t>(view, out);
    case DType::I8:
      return detail::convert_numbers<std::int8_t>(view, out);
    case DType::U16:
      return detail::convert_numbers<std::uint16_t>(view, out);
    case DType::I16:
      return detail::convert_numbers<std::int16_t>(view, out);
    case DType::U32:
      return detail::convert_numbers<std::uint32_t>(view, out);
    case DType::I32:
      return detail::convert_numbers<std::int32_t>(view, out);
    case DType::U64:
      return detail::convert_numbers<std::uint64_t>(view, out);
    case DType::I64:
      return detail::convert_numbers<std::int64_t>(view, out);
    case DType::F16:
      return detail::convert<std::uint16_t>(view, out, [](auto h) { return static_cast<T>(half_to_float(h)); });
    case DType::BF16:
      return detail::convert<std::uint16_t>(view, out, [](auto b) { return static_cast<T>(bfloat16_to_float(b)); });
    case DType::F32:
      return detail::convert_numbers<float>(view, out);
    case DType::F64:
      return detail::convert_numbers<double>(view, out);
    default:
      raise<io_error>(404, "tensor '", view.name, "': elements of type ", view.dtype, " are not supported");
  }
}

#ifdef MOTIONLANG_INSTANTIATED
extern template void copy_values(const TensorView& view, std::span<float> out);
extern template void copy_values(const TensorView& view, std::span<double> out);
#endif

template <class T>
std::vector<T> values_of(const TensorView& view) {
  std::vector<T> out(static_cast<std::size_t>(view.shape.count()));
  copy_values(view, std::span<T>(out));
  return out;
}

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/tensor_view.ipp>
#endif
