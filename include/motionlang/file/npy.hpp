// SPDX-License-Identifier: MIT
/// NumPy arrays: .npy files, versions 1 to 3, with numbers, booleans and texts of fixed width. There are no objects
/// (pickles), records or complex numbers.
#pragma once

#include <concepts>     // kinds of numbers
#include <cstddef>      // byte
#include <cstdint>      // sizes
#include <cstring>      // memcpy
#include <span>         // elements
#include <string>       // texts
#include <string_view>  // names
#include <utility>      // in_range
#include <vector>       // elements

#include <motionlang/core/half.hpp>
#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/detail/npy_header.hpp>
#include <motionlang/file/file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Calls f with a value of the element type that NumPy calls kind and size. Returns false if there is no such type.
/// Halves are passed as HalfBits.
struct HalfBits {
  std::uint16_t bits;
};
template <class F>
bool with_npy_number(char kind, std::size_t size, F f) {
  auto call = [&](auto value) { return f(value), true; };
  switch (kind) {
    case 'f':
      return size == 2 ? call(HalfBits{}) : size == 4 ? call(float{}) : size == 8 && call(double{});
    case 'b':
      return size == 1 && call(std::uint8_t{});  // any byte but 0 is true
    case 'i':
      return size == 1   ? call(std::int8_t{})
             : size == 2 ? call(std::int16_t{})
             : size == 4 ? call(std::int32_t{})
                         : size == 8 && call(std::int64_t{});
    case 'u':
      return size == 1   ? call(std::uint8_t{})
             : size == 2 ? call(std::uint16_t{})
             : size == 4 ? call(std::uint32_t{})
                         : size == 8 && call(std::uint64_t{});
    default:
      return false;
  }
}

template <class T>
constexpr char npy_kind = std::same_as<T, bool>       ? 'b'
                          : std::floating_point<T>    ? 'f'
                          : std::signed_integral<T>   ? 'i'
                          : std::unsigned_integral<T> ? 'u'
                                                      : '?';
/// Elements that a file stores as they are in memory.
template <class T>
concept NpyNumber = std::is_arithmetic_v<T> && sizeof(T) <= 8 && sizeof(bool) == 1;

}  // namespace detail

/// An array as stored in a file: element type, sizes, and the elements, little-endian, in C order (last index fastest).
struct NpyArray {
  char kind = 'f';            // f real, i integer, u unsigned, b boolean, S bytes, U text
  std::size_t item_size = 4;  // bytes of one element; a character of U has four
  std::vector<Index> shape;   // empty: a single value
  std::vector<std::byte> data;
  std::string place = "NpyArray";  // for messages: where it was read

  /// Throws shape_error 205 if the number of values does not fit the shape.
  template <detail::NpyNumber T>
  static NpyArray of(std::span<const T> values, std::vector<Index> shape) {
    NpyArray a{detail::npy_kind<T>, sizeof(T), std::move(shape), {}};
    if (static_cast<Index>(values.size()) != a.count()) {
      raise<shape_error>(205, "NpyArray: ", counted(values.size(), "value"), " for a shape of ", a.count());
    }
    detail::append_bytes(a.data, std::as_bytes(values));
    return a;
  }
  template <detail::NpyNumber T>
  static NpyArray scalar(T value) {
    return of(std::span<const T>(&value, 1), {});
  }
  /// A single text (type U), from UTF-8; bytes that are not UTF-8 become U+FFFD.
  static NpyArray text(std::string_view utf8);

  /// Number of elements.
  Index count() const;
  bool is_text() const { return kind == 'S' || kind == 'U'; }
  /// Element type as NumPy writes it, for instance "<f4".
  std::string type() const;

  /// All elements as T. Real numbers from any number; integers from integers and booleans.
  /// Throws io_error 407 for texts, for real numbers as integers, and for integers out of T's range.
  template <class T>
  requires std::is_arithmetic_v<T> std::vector<T> to()
  const;
  /// The only element as T. Throws io_error 407 if there are more.
  template <class T>
  T value() const {
    require_one();
    return to<T>().front();
  }

  /// All texts as UTF-8, without the NULs that pad them. Throws io_error 407 if the elements are numbers.
  std::vector<std::string> texts() const;
  /// The only text. Throws io_error 407 if there are more, or if it is a number.
  std::string text() const;

 private:
  void require_one() const;
  template <class T, class E>
  T converted(E value) const {
    if constexpr (std::same_as<E, detail::HalfBits>) {
      return converted<T>(half_to_float(value.bits));
    } else if constexpr (std::integral<T> && !std::same_as<T, bool>) {
      if constexpr (std::floating_point<E>) {
        raise<io_error>(407, place, ": real numbers where integers are expected");
      } else {
        if (!std::in_range<T>(value)) raise<io_error>(407, place, ": ", value, " is out of range");
        return static_cast<T>(value);
      }
    } else {
      return static_cast<T>(value);
    }
  }
};

template <class T>
requires std::is_arithmetic_v<T> std::vector<T> NpyArray::to()
const {
  std::vector<T> out;
  out.reserve(static_cast<std::size_t>(count()));
  const bool known = detail::with_npy_number(kind, item_size, [&](auto type_tag) {
    using E = decltype(type_tag);
    for (std::size_t at = 0; at < data.size(); at += sizeof(E)) {
      E value;
      std::memcpy(&value, data.data() + at, sizeof(E));
      out.push_back(converted<T>(value));
    }
  });
  if (!known) raise<io_error>(407, place, ": elements of type ", type(), " are not numbers");
  return out;
}

#ifdef MOTIONLANG_INSTANTIATED
extern template std::vector<float> NpyArray::to() const;
extern template std::vector<double> NpyArray::to() const;
extern template std::vector<std::int64_t> NpyArray::to() const;
#endif

namespace detail {

/// The number of bytes of an array of this shape. Throws io_error 405 if it does not fit into 63 bits, 404 for elements
/// of size 0.
std::size_t checked_size(std::span<const Index> shape, std::size_t item_size, std::string_view where);

/// An array of an element type of NumPy (">f8") and a shape, without its elements. `where` is for messages.
/// Throws  io_error 404 for other element types
NpyArray described_array(std::string_view type, std::vector<Index> shape, std::string_view where);

/// Throws io_error 402 if the data have fewer bytes than the array, 403 if they have more, 405 for impossible sizes.
void check_raw_size(const NpyArray& array, std::size_t bytes, std::string_view where);

/// An array from the bytes that NumPy stores, in .npy files and in pickles. `raw` are all its bytes. Throws like the
/// two above.
NpyArray stored_array(std::string_view type, bool fortran_order, std::vector<Index> shape,
                      std::span<const std::byte> raw, std::string_view where);

inline constexpr std::size_t longest_npy_header = 65536;

/// A .npy file in parts: the contents of its header, and the bytes after it.
struct NpyParts {
  NpyHeader header;
  std::span<const std::byte> raw;
  std::string where;  // for messages
};
/// Throws io_error 402 if the file is too short, 403 if the header is malformed, 404 for other versions, 405 for a long
/// header.
NpyParts npy_parts(std::span<const std::byte> bytes, std::string_view file);

/// Checks the header of a .npy file, in its first bytes, against its size. Throws as parse_npy.
void check_npy_size(std::span<const std::byte> head, std::uint64_t size, std::string_view file);

}  // namespace detail

/// An array from the bytes of a .npy file.
/// file    for messages
/// Throws  io_error 402 if the file is too short, 403 if it is malformed (trailing bytes, too), 404 for other element
///         types and versions, 405 for impossible sizes
NpyArray parse_npy(std::span<const std::byte> bytes, std::string_view file);

/// The bytes of a .npy file, version 1.0, data at a multiple of 64: exactly what numpy.save writes.
std::vector<std::byte> npy_bytes(const NpyArray& array);

/// Throws io_error 401 to 405.
NpyArray read_npy(const FilePath& path);
/// Throws io_error 401.
void write_npy(const FilePath& path, const NpyArray& array);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/npy.ipp>
#endif
