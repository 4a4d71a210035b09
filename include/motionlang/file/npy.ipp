// SPDX-License-Identifier: MIT
// Bodies of npy.hpp.
#pragma once

#include <algorithm>   // reverse
#include <charconv>    // from_chars
#include <functional>  // multiplies
#include <numeric>     // accumulate

#include <motionlang/core/utf8.hpp>
#include <motionlang/file/npy.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY NpyArray NpyArray::text(std::string_view utf8) {
  NpyArray a{'U', 0, {}, {}};
  for (std::size_t at = 0; at < utf8.size();) {
    const char32_t c = decode_utf8(utf8, at);
    detail::append_value(a.data, c == invalid_code_point ? U'\uFFFD' : c);
  }
  if (a.data.empty()) detail::append_value(a.data, U'\0');  // NumPy has no texts of no characters
  a.item_size = a.data.size();
  return a;
}

MOTIONLANG_BODY Index NpyArray::count() const {
  if (std::find(shape.begin(), shape.end(), 0) != shape.end()) return 0;
  return std::accumulate(shape.begin(), shape.end(), Index{1}, std::multiplies<>());
}

MOTIONLANG_BODY std::string NpyArray::type() const {
  const bool one_byte = item_size == 1 || kind == 'S';
  return concat_text(one_byte ? '|' : '<', kind, kind == 'U' ? item_size / 4 : item_size);
}

MOTIONLANG_BODY std::vector<std::string> NpyArray::texts() const {
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

MOTIONLANG_BODY std::string NpyArray::text() const {
  require_one();
  return texts().front();
}

MOTIONLANG_BODY void NpyArray::require_one() const {
  if (count() != 1) raise<io_error>(407, place, ": ", counted(count(), "element"), " where one is expected");
}

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

MOTIONLANG_BODY std::size_t checked_size(std::span<const Index> shape, std::size_t item_size, std::string_view where) {
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

MOTIONLANG_BODY NpyArray described_array(std::string_view type, std::vector<Index> shape, std::string_view where) {
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

MOTIONLANG_BODY void check_raw_size(const NpyArray& array, std::size_t bytes, std::string_view where) {
  const std::size_t needed = checked_size(array.shape, array.item_size, where);
  if (bytes < needed) raise<io_error>(402, where, ": array data of ", counted(bytes, "byte"), ", ", needed, " needed");
  if (bytes > needed) raise<io_error>(403, where, ": ", counted(bytes - needed, "byte"), " after the array data");
}

MOTIONLANG_BODY NpyArray stored_array(std::string_view type, bool fortran_order, std::vector<Index> shape,
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

MOTIONLANG_BODY NpyParts npy_parts(std::span<const std::byte> bytes, std::string_view file) {
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

MOTIONLANG_BODY void check_npy_size(std::span<const std::byte> head, std::uint64_t size, std::string_view file) {
  const NpyParts npy = npy_parts(head, file);
  const std::uint64_t before = head.size() - npy.raw.size();
  if (size < before)
    raise<io_error>(402, npy.where, ": a header of ", counted(before, "byte"), ", the file has ", size);
  check_raw_size(described_array(npy.header.descr, npy.header.shape, npy.where),
                 static_cast<std::size_t>(size - before), npy.where);
}

}  // namespace detail

MOTIONLANG_BODY NpyArray parse_npy(std::span<const std::byte> bytes, std::string_view file) {
  detail::NpyParts npy = detail::npy_parts(bytes, file);
  return detail::stored_array(npy.header.descr, npy.header.fortran_order, std::move(npy.header.shape), npy.raw,
                              npy.where);
}

MOTIONLANG_BODY std::vector<std::byte> npy_bytes(const NpyArray& array) {
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

MOTIONLANG_BODY NpyArray read_npy(const FilePath& path) {
  return parse_npy(MappedFile::open(path)->bytes(), path.string());
}

MOTIONLANG_BODY void write_npy(const FilePath& path, const NpyArray& array) { write_file(path, npy_bytes(array)); }

MOTIONLANG_NAMESPACE_END
