// SPDX-License-Identifier: MIT
/// Zip archives as written by NumPy (.npz) and PyTorch: reads stored and deflated members, writes stored ones.
///
/// The reader trusts only the central directory, and refuses everything that a regular writer does not produce.
/// Encryption and archives in several parts are not supported. Written archives are below 4 GiB.
#pragma once

#include <cstdint>      // sizes
#include <memory>       // shared_ptr
#include <span>         // contents
#include <string>       // names
#include <string_view>  // names
#include <vector>       // members

#include <motionlang/file/detail/bytes.hpp>
#include <motionlang/file/file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// One member: the place of its bytes in the archive, and their expected size and checksum.
struct ZipEntry {
  std::string name;
  std::uint64_t offset = 0;  // of the (packed) data
  std::uint64_t packed = 0;  // bytes in the archive
  std::uint64_t size = 0;    // bytes after unpacking
  std::uint32_t crc = 0;
  bool deflated = false;
};

/// An archive that is open for reading. Its directory is checked on opening, a member on request.
class ZipArchive {
 public:
  /// Throws io_error 401 to 405.
  static ZipArchive open(const FilePath& path);
  /// name    for messages
  /// owner   kept alive as long as the archive, for example the mapped file that holds `bytes`
  ZipArchive(std::span<const std::byte> bytes, std::string name, std::shared_ptr<const void> owner = nullptr);

  const std::string& name() const { return name_; }
  const std::vector<ZipEntry>& entries() const { return entries_; }
  /// The member of that name, or null.
  const ZipEntry* find(std::string_view member) const;

  /// The bytes of a stored member in place, without a copy and without a check of the checksum. Throws io_error 404 if
  /// it is deflated.
  std::span<const std::byte> stored(const ZipEntry& entry) const;
  /// The same with a check of the checksum. Throws io_error 403, 404.
  std::span<const std::byte> checked(const ZipEntry& entry) const;
  /// The first unpacked bytes of a deflated member, at least `count` of them if it has that many. They are not checked.
  /// Throws io_error 402, 403.
  std::vector<std::byte> head(const ZipEntry& entry, std::size_t count) const;
  /// The unpacked bytes, checked against size and checksum.
  /// Throws  io_error 402, 403 if the data are damaged, 405 if there are more than the directory says
  std::vector<std::byte> read(const ZipEntry& entry) const;

 private:
  void check_crc(const ZipEntry& entry, std::span<const std::byte> data) const;
  template <class T>
  T at(std::uint64_t offset, std::string_view what) const {
    return detail::load<T>(bytes_, offset, name_, what);
  }

  /// Finds the end record from the back; with ZIP64 the larger record before it.
  void read_directory();

  /// Reads the directory entry at `position` and returns the position of the next.
  std::uint64_t read_entry(std::uint64_t position);

  /// Extra field 1: eight bytes for each of size, packed and header that does not fit into four.
  void read_zip64(std::uint64_t position, std::uint64_t length, ZipEntry& e, std::uint64_t& header) const;

  static bool leads_out(const std::string& member);

  void check_ranges() const;

  std::span<const std::byte> bytes_;
  std::string name_;
  std::shared_ptr<const void> owner_;
  std::vector<ZipEntry> entries_;
};

/// Writes an archive: add members, then take the bytes. The same members give the same bytes (there are no dates).
class ZipWriter {
 public:
  /// Throws io_error 405 if the archive would need ZIP64.
  void add(std::string_view name, std::span<const std::byte> data);

  /// The whole archive; the writer is empty afterwards.
  std::vector<std::byte> finish();

 private:
  template <class N>
  static void append_numbers(std::vector<std::byte>& out, std::initializer_list<N> numbers) {
    for (const N n : numbers) detail::append_value(out, n);
  }
  std::vector<std::byte> bytes_, directory_;
  std::uint16_t count_ = 0;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/file/zip.ipp>
#endif
