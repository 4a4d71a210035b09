// SPDX-License-Identifier: MIT
// Bodies of safetensors.hpp.
#pragma once

#include <utility>  // exchange

#include <motionlang/core/sort.hpp>
#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/detail/json_cursor.hpp>
#include <motionlang/file/safetensors.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY SafetensorsFile SafetensorsFile::open(const FilePath& path) {
  const auto file = MappedFile::open(path);
  return from_bytes(file->bytes(), path.string(), file);
}

MOTIONLANG_BODY SafetensorsFile SafetensorsFile::from_bytes(std::span<const std::byte> bytes, std::string name,
                                                            std::shared_ptr<const void> owner) {
  return SafetensorsFile(bytes, std::move(name), std::move(owner));
}

MOTIONLANG_BODY SafetensorsFile::SafetensorsFile(std::span<const std::byte> bytes, std::string name,
                                                 std::shared_ptr<const void> owner)
    : TensorSet(std::move(name), std::move(owner)) {
  const auto length = detail::load<std::uint64_t>(bytes, 0, name_, "the header length");
  if (length > max_header)
    raise<io_error>(405, name_, ": a header of ", counted(length, "byte"), "; at most ", max_header,
                    ". Is it a .safetensors file?");
  const auto header = detail::slice(bytes, prefix, length, name_, "the header");
  Cursor json(detail::as_text(header), name_, prefix);
  const auto data = bytes.subspan(prefix + static_cast<std::size_t>(length));

  std::vector<Range> ranges;
  if (json.peek() != '{') json.fail(403, 0, "a header has to begin with '{'");
  json.object([&](const std::string& key) {
    if (key == "__metadata__")
      read_metadata(json);
    else
      ranges.push_back(read_entry(json, key, data));
  });
  json.skip_space();
  if (!json.at_end()) json.fail(403, json.position(), "text behind the header's object");
  check_tiling(json, ranges, data.size());
  detail::sort(tensors_, [](const TensorView& a, const TensorView& b) { return a.name < b.name; });
}

MOTIONLANG_BODY void SafetensorsFile::read_metadata(Cursor& json) {
  json.object([&](const std::string& key) { metadata_[key] = json.string(); });
}

MOTIONLANG_BODY SafetensorsFile::Range SafetensorsFile::read_entry(Cursor& json, const std::string& name,
                                                                   std::span<const std::byte> data) {
  TensorView view{.name = name, .dtype = {}, .shape = {}, .bytes = {}};
  std::vector<std::int64_t> offsets;
  bool has_type = false, has_shape = false;
  const std::size_t at = json.position();
  json.object([&](const std::string& member) {
    if (member == "dtype") {
      view.dtype = read_dtype(json);
      has_type = true;
    } else if (member == "shape") {
      view.shape = read_shape(json);
      has_shape = true;
    } else if (member == "data_offsets") {
      json.array([&] {
        if (offsets.size() == 2) json.fail(403, json.position(), "more than two data_offsets");
        offsets.push_back(json.count());
      });
    } else {
      json.skip_value();
    }
  });
  if (!has_type || !has_shape || offsets.size() != 2) {
    json.fail(403, at, "tensor '" + view.name + "' lacks one of dtype, shape, data_offsets [begin, end]");
  }
  const Range range{static_cast<std::uint64_t>(offsets[0]), static_cast<std::uint64_t>(offsets[1]), at};
  check_size(json, view, range);
  if (range.end > data.size()) {
    json.fail(
        402, at,
        concat_text("tensor '", view.name, "' ends at ", range.end, ", the data have ", counted(data.size(), "byte")));
  }
  view.bytes = data.subspan(range.begin, range.end - range.begin);
  tensors_.push_back(std::move(view));
  return range;
}

MOTIONLANG_BODY DType SafetensorsFile::read_dtype(Cursor& json) {
  const std::size_t at = json.position();
  const std::string text = json.string();
  const auto dtype = parse_dtype(text);
  if (!dtype) json.fail(404, at, "unknown dtype '" + text + "'");
  return *dtype;
}

MOTIONLANG_BODY FileShape SafetensorsFile::read_shape(Cursor& json) {
  FileShape shape;
  json.array([&] {
    if (shape.rank() == FileShape::max_rank) {
      json.fail(404, json.position(), concat_text("more than ", FileShape::max_rank, " axes are not supported"));
    }
    shape.push_back(json.count());
  });
  return shape;
}

MOTIONLANG_BODY void SafetensorsFile::check_size(const Cursor& json, const TensorView& view, const Range& range) {
  constexpr std::uint64_t most_bits = std::uint64_t{1} << 62;
  std::uint64_t bits = static_cast<std::uint64_t>(info(view.dtype).bits);
  bool empty = false;
  for (int axis = 0; axis < view.shape.rank(); ++axis) {
    const auto n = static_cast<std::uint64_t>(view.shape[axis]);
    empty = empty || n == 0;
    if (n > 1 && bits > most_bits / n) {
      json.fail(405, range.declared_at, concat_text("tensor '", view.name, "': shape ", view.shape, " is too large"));
    }
    bits *= n > 1 ? n : 1;
  }
  if (empty) bits = 0;
  if (range.begin > range.end || bits % 8 != 0 || range.end - range.begin != bits / 8) {
    json.fail(405, range.declared_at,
              concat_text("tensor '", view.name, "': ", view.dtype, " ", view.shape, " does not fill data_offsets [",
                          range.begin, ", ", range.end, "]"));
  }
}

MOTIONLANG_BODY void SafetensorsFile::check_tiling(const Cursor& json, std::vector<Range>& ranges, std::uint64_t size) {
  detail::sort(ranges,
               [](const Range& a, const Range& b) { return a.begin != b.begin ? a.begin < b.begin : a.end < b.end; });
  std::uint64_t end = 0;
  for (const Range& r : ranges) {
    if (r.begin != end) {
      json.fail(
          403, r.declared_at,
          concat_text("data_offsets [", r.begin, ", ", r.end, "] ",
                      r.begin < end ? "overlap the range before, which ends at " : "leave a hole after byte ", end));
    }
    end = r.end;
  }
  if (end != size)
    json.fail(403, 0,
              concat_text(counted(size - end, "byte of data belongs", "bytes of data belong"), " to no tensor"));
}

namespace detail {

/// A JSON string. Throws io_error 403 if the text is not UTF-8.
inline void append_json_string(std::string& out, std::string_view text) {
  if (!is_utf8(text)) raise<io_error>(403, "safetensors: the name '", text, "' is not UTF-8");
  constexpr std::string_view digits = "0123456789abcdef";
  out += '"';
  for (char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\', out += c;
    } else if (static_cast<unsigned char>(c) < 0x20) {
      out += "\\u00";
      out += digits[static_cast<std::size_t>(c >> 4)], out += digits[static_cast<std::size_t>(c & 15)];
    } else {
      out += c;
    }
  }
  out += '"';
}

inline std::string safetensors_header(std::span<const TensorView* const> order,
                                      const std::map<std::string, std::string>& metadata) {
  std::string json = "{";
  const auto separate = [&] { json += json.size() > 1 ? "," : ""; };
  if (!metadata.empty()) {
    json += "\"__metadata__\":";
    char before = '{';
    for (const auto& [key, value] : metadata) {
      json += std::exchange(before, ',');
      append_json_string(json, key), json += ':', append_json_string(json, value);
    }
    json += '}';
  }
  std::size_t at = 0;
  for (const TensorView* t : order) {
    separate();
    append_json_string(json, t->name);
    json += concat_text(":{\"dtype\":\"", t->dtype, "\",\"shape\":[", join_text(t->shape.sizes(), ","),
                        "],\"data_offsets\":[", at, ",", at + t->bytes.size(), "]}");
    at += t->bytes.size();
  }
  json += '}';
  json.append((8 - json.size() % 8) % 8, ' ');
  return json;
}

}  // namespace detail

MOTIONLANG_BODY std::vector<std::byte> safetensors_bytes(std::span<const TensorView> tensors,
                                                         const std::map<std::string, std::string>& metadata) {
  std::vector<const TensorView*> order;
  std::size_t size = 0;
  for (const TensorView& t : tensors) order.push_back(&t), size += t.bytes.size();
  detail::sort(order, [](const TensorView* a, const TensorView* b) {
    const int bits_a = info(a->dtype).bits, bits_b = info(b->dtype).bits;
    return bits_a != bits_b ? bits_a > bits_b : a->name < b->name;
  });
  const std::string header = detail::safetensors_header(order, metadata);
  std::vector<std::byte> out;
  out.reserve(sizeof(std::uint64_t) + header.size() + size);
  detail::append_value(out, std::uint64_t{header.size()});
  detail::append_text(out, header);
  for (const TensorView* t : order) detail::append_bytes(out, t->bytes);
  SafetensorsFile::from_bytes(out, "safetensors to be written");
  return out;
}

MOTIONLANG_BODY void write_safetensors(const FilePath& path, std::span<const TensorView> tensors,
                                       const std::map<std::string, std::string>& metadata) {
  write_file(path, safetensors_bytes(tensors, metadata));
}

MOTIONLANG_NAMESPACE_END
