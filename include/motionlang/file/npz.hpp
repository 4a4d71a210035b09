// SPDX-License-Identifier: MIT
/// NumPy's .npz archives: several arrays in a zip, array "poses" as member "poses.npy". Written uncompressed.
#pragma once

#include <motionlang/file/npy.hpp>
#include <motionlang/file/zip.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// An archive that is being read. Arrays are read when they are asked for: members that we cannot read (objects) do not
/// disturb the others.
class NpzArchive {
 public:
  /// Throws io_error 401 to 405.
  static NpzArchive open(const FilePath& path) { return NpzArchive(ZipArchive::open(path)); }
  explicit NpzArchive(ZipArchive zip) : zip_(std::move(zip)) {}

  const std::string& file() const { return zip_.name(); }
  std::vector<std::string> names() const {
    std::vector<std::string> out;
    for (const ZipEntry& e : zip_.entries()) {
      if (e.name.ends_with(suffix)) out.push_back(e.name.substr(0, e.name.size() - suffix.size()));
    }
    return out;
  }
  bool has(std::string_view name) const { return zip_.find(concat_text(name, suffix)) != nullptr; }

  /// Throws  io_error 406 if there is no such array, 402 to 405 if it cannot be read
  NpyArray read(std::string_view name) const {
    const ZipEntry* entry = zip_.find(concat_text(name, suffix));
    if (entry == nullptr) raise<io_error>(406, zip_.name(), ": no array '", name, "' in the archive");
    const std::string where = concat_text(zip_.name(), "/", name);
    constexpr std::uint64_t large = 1 << 20;  // then it is not unpacked before its header is known to want so much
    if (entry->deflated && entry->size > large)
      detail::check_npy_size(zip_.head(*entry, detail::longest_npy_header + 12), entry->size, where);
    return parse_npy(zip_.read(*entry), where);
  }

 private:
  static constexpr std::string_view suffix = ".npy";
  ZipArchive zip_;
};

struct NamedArray {
  std::string name;
  NpyArray array;
};

/// Throws io_error 405 above 4 GiB.
inline std::vector<std::byte> npz_bytes(std::span<const NamedArray> arrays) {
  ZipWriter zip;
  for (const NamedArray& a : arrays) zip.add(a.name + ".npy", npy_bytes(a.array));
  return zip.finish();
}
/// Throws io_error 401 if the file cannot be written, 405 above 4 GiB.
inline void write_npz(const FilePath& path, std::span<const NamedArray> arrays) { write_file(path, npz_bytes(arrays)); }

MOTIONLANG_NAMESPACE_END
