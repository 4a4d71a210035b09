// SPDX-License-Identifier: MIT
// Bodies of zip.hpp.
#pragma once

#include <algorithm>      // stable_sort
#include <limits>         // no limit
#include <unordered_set>  // repeated names
#include <utility>        // exchange

#include <motionlang/file/detail/inflate.hpp>
#include <motionlang/file/zip.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY ZipArchive ZipArchive::open(const FilePath& path) {
  auto file = MappedFile::open(path);
  return ZipArchive(file->bytes(), path.string(), file);
}

MOTIONLANG_BODY ZipArchive::ZipArchive(std::span<const std::byte> bytes, std::string name,
                                       std::shared_ptr<const void> owner)
    : bytes_(bytes), name_(std::move(name)), owner_(std::move(owner)) {
  read_directory();
  check_ranges();
}

MOTIONLANG_BODY const ZipEntry* ZipArchive::find(std::string_view member) const {
  for (const ZipEntry& e : entries_) {
    if (e.name == member) return &e;
  }
  return nullptr;
}

MOTIONLANG_BODY std::span<const std::byte> ZipArchive::stored(const ZipEntry& entry) const {
  if (entry.deflated)
    raise<io_error>(404, name_, ": member '", entry.name, "' at byte ", entry.offset, " is compressed");
  return bytes_.subspan(static_cast<std::size_t>(entry.offset), static_cast<std::size_t>(entry.packed));
}

MOTIONLANG_BODY std::span<const std::byte> ZipArchive::checked(const ZipEntry& entry) const {
  const auto data = stored(entry);
  check_crc(entry, data);
  return data;
}

MOTIONLANG_BODY std::vector<std::byte> ZipArchive::head(const ZipEntry& entry, std::size_t count) const {
  const auto raw = bytes_.subspan(static_cast<std::size_t>(entry.offset), static_cast<std::size_t>(entry.packed));
  std::vector<std::byte> out;
  detail::inflate_to(out, raw, std::numeric_limits<std::size_t>::max(), name_ + "/" + entry.name, count);
  return out;
}

MOTIONLANG_BODY std::vector<std::byte> ZipArchive::read(const ZipEntry& entry) const {
  const auto raw = bytes_.subspan(static_cast<std::size_t>(entry.offset), static_cast<std::size_t>(entry.packed));
  const std::string where = name_ + "/" + entry.name;
  const auto size = static_cast<std::size_t>(entry.size);
  std::vector<std::byte> data =
      entry.deflated ? detail::inflate(raw, size, where, size).data : std::vector<std::byte>(raw.begin(), raw.end());
  if (data.size() != entry.size) {
    raise<io_error>(403, where, " at byte ", entry.offset, ": unpacks to ", counted(data.size(), "byte"),
                    ", the directory says ", entry.size);
  }
  check_crc(entry, data);
  return data;
}

MOTIONLANG_BODY void ZipArchive::check_crc(const ZipEntry& entry, std::span<const std::byte> data) const {
  if (const std::uint32_t crc = detail::crc32(data); crc != entry.crc) {
    raise<io_error>(403, name_, "/", entry.name, " at byte ", entry.offset, ": checksum ", crc, ", the directory says ",
                    entry.crc);
  }
}

MOTIONLANG_BODY void ZipArchive::read_directory() {
  constexpr std::uint64_t end_size = 22, longest_comment = 65535, locator_size = 20;
  if (bytes_.size() < end_size)
    raise<io_error>(403, name_, ": ", counted(bytes_.size(), "byte is", "bytes are"), " too short for a zip archive");
  std::uint64_t end = bytes_.size() - end_size;
  const std::uint64_t first = end > longest_comment ? end - longest_comment : 0;
  while (at<std::uint32_t>(end, "end record") != 0x06054B50u) {
    if (end == first)
      raise<io_error>(403, name_, ": no end record of a zip archive from byte ", first, " on: not a zip, or cut off");
    --end;
  }
  std::uint64_t count = at<std::uint16_t>(end + 10, "end record"), size = at<std::uint32_t>(end + 12, "end record");
  std::uint64_t start = at<std::uint32_t>(end + 16, "end record");
  if (at<std::uint16_t>(end + 4, "end record") != at<std::uint16_t>(end + 6, "end record")) {
    raise<io_error>(404, name_, ": zip archive in several parts, says its end record at byte ", end);
  }
  if (end >= locator_size && at<std::uint32_t>(end - locator_size, "ZIP64 locator") == 0x07064B50u) {
    const auto large = at<std::uint64_t>(end - locator_size + 8, "ZIP64 locator");
    if (at<std::uint32_t>(large, "ZIP64 end record") != 0x06064B50u) {
      raise<io_error>(403, name_, ": no ZIP64 end record at byte ", large);
    }
    count = at<std::uint64_t>(large + 32, "ZIP64 end record");
    size = at<std::uint64_t>(large + 40, "ZIP64 end record");
    start = at<std::uint64_t>(large + 48, "ZIP64 end record");
  }
  const auto directory = detail::slice(bytes_, start, size, name_, "zip directory");
  constexpr std::uint64_t most_members = 100'000;
  if (count > most_members)
    raise<io_error>(405, name_, ": ", counted(count, "member"), ", says the end record at byte ", end, "; at most ",
                    most_members);
  std::uint64_t position = start;
  for (std::uint64_t i = 0; i < count; ++i) position = read_entry(position);
  if (position > start + directory.size())
    raise<io_error>(403, name_, ": zip directory runs past its end at byte ", start + directory.size());
}

MOTIONLANG_BODY std::uint64_t ZipArchive::read_entry(std::uint64_t position) {
  constexpr std::string_view what = "zip directory entry";
  if (at<std::uint32_t>(position, what) != 0x02014B50u) {
    raise<io_error>(403, name_, ": no zip directory entry at byte ", position);
  }
  const auto flags = at<std::uint16_t>(position + 8, what), method = at<std::uint16_t>(position + 10, what);
  const auto name_size = at<std::uint16_t>(position + 28, what), extra_size = at<std::uint16_t>(position + 30, what);
  const auto comment_size = at<std::uint16_t>(position + 32, what);
  ZipEntry e;
  e.name = detail::as_text(detail::slice(bytes_, position + 46, name_size, name_, what));
  e.crc = at<std::uint32_t>(position + 16, what);
  e.packed = at<std::uint32_t>(position + 20, what);
  e.size = at<std::uint32_t>(position + 24, what);
  e.deflated = method == 8;
  std::uint64_t header = at<std::uint32_t>(position + 42, what);
  read_zip64(position + 46 + name_size, extra_size, e, header);

  const auto refuse = [&](int id, const auto&... why) {
    raise<io_error>(id, name_, ": zip directory entry at byte ", position, ": member '", e.name, "' ", why...);
  };
  if ((flags & 1u) != 0) refuse(404, "is encrypted");
  if (method != 0 && method != 8) refuse(404, "has method ", method);
  if (!e.deflated && e.packed != e.size) refuse(403, "is stored and has ", e.packed, " and ", counted(e.size, "byte"));
  constexpr std::uint64_t highest_ratio = 1032;  // of deflate: 258 bytes from two bits
  if (e.deflated && e.size / highest_ratio > e.packed)
    refuse(405, "of ", counted(e.size, "byte"), " cannot come from ", e.packed);
  if (leads_out(e.name)) refuse(403, "leads out of the archive");
  if (at<std::uint32_t>(header, "zip member") != 0x04034B50u) {
    raise<io_error>(403, name_, ": no member '", e.name, "' at byte ", header);
  }
  e.offset = header + 30 + at<std::uint16_t>(header + 26, "zip member") + at<std::uint16_t>(header + 28, "zip member");
  detail::slice(bytes_, e.offset, e.packed, name_, e.name);
  entries_.push_back(std::move(e));
  return position + 46 + name_size + extra_size + comment_size;
}

MOTIONLANG_BODY void ZipArchive::read_zip64(std::uint64_t position, std::uint64_t length, ZipEntry& e,
                                            std::uint64_t& header) const {
  const std::uint64_t end = position + length;
  while (position + 4 <= end) {
    const auto id = at<std::uint16_t>(position, "extra field"), size = at<std::uint16_t>(position + 2, "extra field");
    position += 4;
    if (id == 1) {
      std::uint64_t value = position;
      for (std::uint64_t* number : {&e.size, &e.packed, &header}) {
        if (*number != 0xFFFFFFFFu) continue;
        *number = at<std::uint64_t>(value, "ZIP64 extra field");
        value += 8;
      }
    }
    position += size;
  }
}

MOTIONLANG_BODY bool ZipArchive::leads_out(const std::string& member) {
  return member.empty() || member.front() == '/' || ("/" + member + "/").find("/../") != std::string::npos ||
         member.find_first_of(std::string_view("\0\\", 2)) != std::string::npos;
}

MOTIONLANG_BODY void ZipArchive::check_ranges() const {
  std::unordered_set<std::string_view> names;
  std::vector<const ZipEntry*> sorted;
  for (const ZipEntry& e : entries_) {
    if (!names.insert(e.name).second)
      raise<io_error>(403, name_, ": two members are called '", e.name, "', one of them at byte ", e.offset);
    sorted.push_back(&e);
  }
  std::stable_sort(sorted.begin(), sorted.end(), [](auto* a, auto* b) { return a->offset < b->offset; });
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    if (sorted[i - 1]->offset + sorted[i - 1]->packed > sorted[i]->offset) {
      raise<io_error>(403, name_, ": members '", sorted[i - 1]->name, "' and '", sorted[i]->name, "' overlap at byte ",
                      sorted[i]->offset);
    }
  }
}

MOTIONLANG_BODY void ZipWriter::add(std::string_view name, std::span<const std::byte> data) {
  if (data.size() + bytes_.size() > 0xFFFF0000u || name.size() > 0xFFFFu || count_ == 0xFFFFu) {
    raise<io_error>(405, "zip: member '", name, "' of ", counted(data.size(), "byte"),
                    " is too much for a zip without ZIP64");
  }
  std::vector<std::byte> common;                               // what the local header and the directory have in common
  append_numbers<std::uint16_t>(common, {20, 0, 0, 0, 0x21});  // version, flags, stored, 0:00 of 1980-01-01
  append_numbers<std::uint32_t>(
      common, {detail::crc32(data), static_cast<std::uint32_t>(data.size()), static_cast<std::uint32_t>(data.size())});
  append_numbers<std::uint16_t>(common, {static_cast<std::uint16_t>(name.size()), 0});

  append_numbers<std::uint32_t>(directory_, {0x02014B50u});
  append_numbers<std::uint16_t>(directory_, {20});
  detail::append_bytes(directory_, common);
  append_numbers<std::uint16_t>(directory_, {0, 0, 0, 0, 0});
  append_numbers<std::uint32_t>(directory_, {static_cast<std::uint32_t>(bytes_.size())});
  detail::append_text(directory_, name);

  append_numbers<std::uint32_t>(bytes_, {0x04034B50u});
  detail::append_bytes(bytes_, common);
  detail::append_text(bytes_, name);
  detail::append_bytes(bytes_, data);
  ++count_;
}

MOTIONLANG_BODY std::vector<std::byte> ZipWriter::finish() {
  const auto start = static_cast<std::uint32_t>(bytes_.size());
  detail::append_bytes(bytes_, directory_);
  append_numbers<std::uint32_t>(bytes_, {0x06054B50u});
  append_numbers<std::uint16_t>(bytes_, {0, 0, count_, count_});
  append_numbers<std::uint32_t>(bytes_, {static_cast<std::uint32_t>(directory_.size()), start});
  append_numbers<std::uint16_t>(bytes_, {0});
  return std::exchange(*this, ZipWriter()).bytes_;
}

MOTIONLANG_NAMESPACE_END
