// SPDX-License-Identifier: MIT
/// NumPy arrays: .npy files, versions 1 to 3. Numbers, booleans and texts of fixed width; neither objects (a pickle)
/// nor records nor complex numbers.
#pragma once

#include <algorithm>   // reverse
#include <functional>  // multiplies
#include <numeric>     // accumulate
#include <utility>     // in_range

#include <motionlang/core/half.hpp>
#include <motionlang/core/utf8.hpp>
#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/detail/npy_header.hpp>
#include <motionlang/file/file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Calls f with a value of the element type that NumPy calls kind and size; false if there is no such number. Halves
/// are handed over as HalfBits.
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
/// Elements that are stored as they are in memory.
template <class T>
concept NpyNumber = std::is_arithmetic_v<T> && sizeof(T) <= 8 && sizeof(bool) == 1;

}  // namespace detail

/// An array as a file holds it: element type, sizes, and the elements, little-endian, in C order (last index fastest).
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
  static NpyArray text(std::string_view utf8) {
    NpyArray a{'U', 0, {}, {}};
    for (std::size_t at = 0; at < utf8.size();) {
      const char32_t c = decode_utf8(utf8, at);
      detail::append_value(a.data, c == invalid_code_point ? U'\uFFFD' : c);
    }
    if (a.data.empty()) detail::append_value(a.data, U'\0');  // NumPy has no texts of no characters
    a.item_size = a.data.size();
    return a;
  }

  /// Number of elements.
  Index count() const {
    if (std::find(shape.begin(), shape.end(), 0) != shape.end()) return 0;
    return std::accumulate(shape.begin(), shape.end(), Index{1}, std::multiplies<>());
  }
  bool is_text() const { return kind == 'S' || kind == 'U'; }
  /// Element type as NumPy writes it, for instance "<f4".
  std::string type() const {
    const bool one_byte = item_size == 1 || kind == 'S';
    return concat_text(one_byte ? '|' : '<', kind, kind == 'U' ? item_size / 4 : item_size);
  }

  /// All elements as T. Real numbers from any number; integers from integers and booleans.
  /// Throws io_error 407 for texts, for real numbers as integers, and for integers out of T's range.
  template <class T>
  requires std::is_arithmetic_v<T> std::vector<T> to()
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
  /// The only element as T. Throws io_error 407 if there are more.
  template <class T>
  T value() const {
    require_one();
    return to<T>().front();
  }

  /// All texts as UTF-8, without the NULs that fill them up. Throws io_error 407 if the elements are numbers.
  std::vector<std::string> texts() const {
    if (!is_text()) raise<io_error>(407, place, ": elements of type ", type(), " are not texts");
    std::vector<std::string> out(static_cast<std::size_t>(count()));
    const std::size_t unit = kind == 'U' ? 4 : 1;
    for (std::size_t i = 0; i < out.size(); ++i) {
      for (std::size_t at = i * item_size; at < (i + 1) * item_size; at += unit) {
        char32_t c = 0;
        std::memcpy(&c, data.data() + at, unit);
        if (kind == 'S') {
          out[i] += static_cast<char>(c);
        } else {
          append_utf8(out[i], c > 0x10FFFF || (c >= 0xD800 && c < 0xE000) ? U'\uFFFD' : c);
        }
      }
      out[i].erase(out[i].find_last_not_of('\0') + 1);
    }
    return out;
  }
  /// The only text. Throws io_error 407 if there are more, or if it is a number.
  std::string text() const {
    require_one();
    return texts().front();
  }

 private:
  void require_one() const {
    if (count() != 1) raise<io_error>(407, place, ": ", counted(count(), "element"), " where one is expected");
  }
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

namespace detail {

/// Reorders elements whose first index is the fastest to C order. Visits them in C order with an odometer of indices.
inline std::vector<std::byte> from_fortran_order(std::span<const std::byte> in, std::span<const Index> shape,
                                                 std::size_t item_size) {
  std::vector<std::byte> out;
  out.reserve(in.size());
  std::vector<std::size_t> index(shape.size(), 0), stride(shape.size(), item_size);
  for (std::size_t d = 1; d < shape.size(); ++d) stride[d] = stride[d - 1] * static_cast<std::size_t>(shape[d - 1]);
  std::size_t at = 0;
  while (out.size() < in.size()) {
    append_bytes(out, in.subspan(at, item_size));
    for (std::size_t d = shape.size(); d-- > 0;) {
      at += stride[d];
      if (++index[d] < static_cast<std::size_t>(shape[d])) break;
      at -= stride[d] * index[d];
      index[d] = 0;
    }
  }
  return out;
}

/// Bytes of an array of this shape. Throws io_error 405 if they cannot be counted in 63 bits, 404 for elements of no
/// size.
inline std::size_t checked_size(std::span<const Index> shape, std::size_t item_size, std::string_view where) {
  if (std::find(shape.begin(), shape.end(), 0) != shape.end()) return 0;
  std::uint64_t size = item_size;
  if (size == 0) raise<io_error>(404, where, ": elements of no size");
  for (const Index n : shape) {
    if (size > static_cast<std::uint64_t>(INT64_MAX) / static_cast<std::uint64_t>(n)) {
      raise<io_error>(405, where, ": the product of the shape is too large");
    }
    size *= static_cast<std::uint64_t>(n);
  }
  return static_cast<std::size_t>(size);
}

/// An array of an element type of NumPy (">f8") and a shape, without its elements. `where` is for messages.
/// Throws  io_error 404 for other element types
inline NpyArray described_array(std::string_view type, std::vector<Index> shape, std::string_view where) {
  NpyArray array;
  array.shape = std::move(shape);
  array.place = where;
  std::size_t digits = 0;
  const char* end = type.data() + type.size();
  if (type.size() < 3 || std::from_chars(type.data() + 2, end, digits).ptr != end || digits > 1'000'000'000) {
    raise<io_error>(404, where, ": element type '", type, "'");
  }
  array.kind = type[1];
  array.item_size = array.kind == 'U' ? 4 * digits : digits;
  const bool known_order = type[0] == '<' || type[0] == '>' || type[0] == '|' || type[0] == '=';
  if (!known_order || !(array.is_text() || with_npy_number(array.kind, digits, [](auto) {}))) {
    raise<io_error>(404, where, ": element type '", type, "'");
  }
  return array;
}

/// Throws io_error 402 if the data have fewer bytes than the array, 403 if they have more, 405 for impossible sizes.
inline void check_raw_size(const NpyArray& array, std::size_t bytes, std::string_view where) {
  const std::size_t needed = checked_size(array.shape, array.item_size, where);
  if (bytes < needed) raise<io_error>(402, where, ": array data of ", counted(bytes, "byte"), ", ", needed, " needed");
  if (bytes > needed) raise<io_error>(403, where, ": ", counted(bytes - needed, "byte"), " after the array data");
}

/// An array as NumPy stores it, in .npy files and in pickles. `raw` are all its bytes. Throws like the two above.
inline NpyArray stored_array(std::string_view type, bool fortran_order, std::vector<Index> shape,
                             std::span<const std::byte> raw, std::string_view where) {
  NpyArray array = described_array(type, std::move(shape), where);
  check_raw_size(array, raw.size(), where);
  array.data = fortran_order ? from_fortran_order(raw, array.shape, array.item_size)
                             : std::vector<std::byte>(raw.begin(), raw.end());
  const std::size_t unit = array.kind == 'U' ? 4 : array.kind == 'S' ? 1 : array.item_size;
  if (type[0] == '>') {
    for (auto at = array.data.begin(); at != array.data.end(); at += static_cast<std::ptrdiff_t>(unit)) {
      std::reverse(at, at + static_cast<std::ptrdiff_t>(unit));
    }
  }
  return array;
}

inline constexpr std::size_t longest_npy_header = 65536;

/// A .npy file in parts: what its header says, and the bytes behind it.
struct NpyParts {
  NpyHeader header;
  std::span<const std::byte> raw;
  std::string where;  // for messages
};
/// Throws io_error 402 if the file is too short, 403 if the header is malformed, 404 for other versions, 405 for a long
/// header.
inline NpyParts npy_parts(std::span<const std::byte> bytes, std::string_view file) {
  constexpr std::string_view magic = "\x93NUMPY";
  if (!as_text(bytes).starts_with(magic)) raise<io_error>(403, file, ": not a .npy file (byte 0)");
  const auto major = load<std::uint8_t>(bytes, 6, file, "npy version");
  if (major < 1 || major > 3) raise<io_error>(404, file, ": .npy version ", int{major}, " at byte 6");
  const std::size_t length = major == 1 ? load<std::uint16_t>(bytes, 8, file, "npy header length")
                                        : load<std::uint32_t>(bytes, 8, file, "npy header length");
  if (length > longest_npy_header)
    raise<io_error>(405, file, ": npy header of ", counted(length, "byte"), " at byte 8");
  const std::size_t start = major == 1 ? 10 : 12;
  return {NpyHeader(as_text(slice(bytes, start, length, file, "npy header")), start, file),
          bytes.subspan(start + length), concat_text(file, ": npy at byte ", start)};
}

/// Compares the header of a .npy file, of which the first bytes are given, with its size. Throws as parse_npy.
inline void check_npy_size(std::span<const std::byte> head, std::uint64_t size, std::string_view file) {
  const NpyParts npy = npy_parts(head, file);
  const std::uint64_t before = head.size() - npy.raw.size();
  if (size < before)
    raise<io_error>(402, npy.where, ": a header of ", counted(before, "byte"), ", the file has ", size);
  check_raw_size(described_array(npy.header.descr, npy.header.shape, npy.where),
                 static_cast<std::size_t>(size - before), npy.where);
}

}  // namespace detail

/// An array from the bytes of a .npy file.
/// file    for messages
/// Throws  io_error 402 if the file is too short, 403 if it is malformed (trailing bytes, too), 404 for other element
///         types and versions, 405 for impossible sizes
inline NpyArray parse_npy(std::span<const std::byte> bytes, std::string_view file) {
  detail::NpyParts npy = detail::npy_parts(bytes, file);
  return detail::stored_array(npy.header.descr, npy.header.fortran_order, std::move(npy.header.shape), npy.raw,
                              npy.where);
}

/// The bytes of a .npy file, version 1.0, data at a multiple of 64: exactly what numpy.save writes.
inline std::vector<std::byte> npy_bytes(const NpyArray& array) {
  std::string header = concat_text("{'descr': '", array.type(), "', 'fortran_order': False, 'shape': (",
                                   join_text(array.shape), array.shape.size() == 1 ? ",), }" : "), }");
  constexpr std::size_t before = 10, alignment = 64;
  header.append(alignment - 1 - (before + header.size()) % alignment, ' ');
  header += '\n';
  std::vector<std::byte> out;
  detail::append_text(out, std::string_view("\x93NUMPY\x01\x00", 8));
  detail::append_value(out, static_cast<std::uint16_t>(header.size()));
  detail::append_text(out, header);
  detail::append_bytes(out, array.data);
  return out;
}

/// Throws io_error 401 to 405.
inline NpyArray read_npy(const FilePath& path) { return parse_npy(MappedFile::open(path)->bytes(), path.string()); }
/// Throws io_error 401.
inline void write_npy(const FilePath& path, const NpyArray& array) { write_file(path, npy_bytes(array)); }

MOTIONLANG_NAMESPACE_END
