// SPDX-License-Identifier: MIT
// Bodies of npz.hpp.
#pragma once

#include <motionlang/file/npz.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<std::string> NpzArchive::names() const {
  std::vector<std::string> out;
  for (const ZipEntry& e : zip_.entries()) {
    if (e.name.ends_with(suffix)) out.push_back(e.name.substr(0, e.name.size() - suffix.size()));
  }
  return out;
}

MOTIONLANG_BODY bool NpzArchive::has(std::string_view name) const {
  return zip_.find(concat_text(name, suffix)) != nullptr;
}

MOTIONLANG_BODY NpyArray NpzArchive::read(std::string_view name) const {
  const ZipEntry* entry = zip_.find(concat_text(name, suffix));
  if (entry == nullptr) raise<io_error>(406, zip_.name(), ": no array '", name, "' in the archive");
  const std::string where = concat_text(zip_.name(), "/", name);
  constexpr std::uint64_t large = 1 << 20;  // a larger entry is unpacked only after its header has asked for so much
  if (entry->deflated && entry->size > large)
    detail::check_npy_size(zip_.head(*entry, detail::longest_npy_header + 12), entry->size, where);
  return parse_npy(zip_.read(*entry), where);
}

MOTIONLANG_BODY std::vector<std::byte> npz_bytes(std::span<const NamedArray> arrays) {
  ZipWriter zip;
  for (const NamedArray& a : arrays) zip.add(a.name + ".npy", npy_bytes(a.array));
  return zip.finish();
}

MOTIONLANG_BODY void write_npz(const FilePath& path, std::span<const NamedArray> arrays) {
  write_file(path, npz_bytes(arrays));
}

MOTIONLANG_NAMESPACE_END
