// Zip archives and deflate: what is written comes back, and every damaged byte is noticed or harmless.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include <motionlang/file/detail/inflate.hpp>
#include <motionlang/file/zip.hpp>

namespace ml = motionlang;

namespace {

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

std::string inflated(std::string_view base64, std::size_t limit = 1000) {
  const auto out = ml::detail::inflate(ml::detail::from_base64(base64), limit, "test");
  return std::string(ml::detail::as_text(out.data));
}

std::vector<std::byte> two_members() {
  ml::ZipWriter zip;
  zip.add("a.txt", bytes_of("walk"));
  zip.add("folder/b.txt", bytes_of(""));
  return zip.finish();
}

template <class T>
std::vector<std::byte> patched(std::vector<std::byte> bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
  return bytes;
}

/// Position of the n-th directory entry.
std::size_t directory_entry(std::span<const std::byte> bytes, int n) {
  std::size_t at = 0;
  for (int i = 0; i <= n; ++i) at = ml::detail::as_text(bytes).find("PK\x01\x02", at + 1);
  return at;
}

}  // namespace

TEST_CASE("checksum and base64") {
  CHECK(ml::detail::crc32(bytes_of("123456789")) == 0xCBF43926u);  // the check value of this CRC
  for (const auto& [text, code] :
       {std::pair{"", ""}, {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foob", "Zm9vYg=="}}) {
    CHECK(ml::detail::to_base64(bytes_of(text)) == code);
    CHECK(ml::detail::as_text(ml::detail::from_base64(code)) == text);
  }
  CHECK_THROWS_WITH_AS(ml::detail::from_base64("Zm9*"), doctest::Contains("403] text: character 3 "), ml::io_error);
}

TEST_CASE("the three kinds of deflate block") {
  CHECK(inflated("K0/MyVYoRyVKSovyAA==") == "walk walk walk walk turn");                      // fixed codes
  CHECK(inflated("ARgA5/93YWxrIHdhbGsgd2FsayB3YWxrIHR1cm4=") == "walk walk walk walk turn");  // stored
  // dynamic codes: tests/unit/file/npy.cpp reads an archive that zlib compressed
}

TEST_CASE("malformed deflate streams") {
  CHECK_THROWS_WITH_AS(inflated("K0/MyVYoRyVKSovyAA==", 23), doctest::Contains("405"), ml::io_error);
  CHECK_THROWS_WITH_AS(inflated("ARgA5/93YWxr", 5), doctest::Contains("405"), ml::io_error);
  CHECK_THROWS_WITH_AS(inflated("ARgA5/93YWxr"), doctest::Contains("402"), ml::io_error);
  CHECK_THROWS_WITH_AS(inflated("ARgA5v93YWxr"), doctest::Contains("403"), ml::io_error);  // length and its complement
  CHECK_THROWS_WITH_AS(inflated("Bw=="), doctest::Contains("unknown kind"), ml::io_error);
  CHECK_THROWS_WITH_AS(inflated("K0/M"), doctest::Contains("402"), ml::io_error);
  CHECK_THROWS_WITH_AS(inflated(""), doctest::Contains("402"), ml::io_error);
  CHECK_THROWS_WITH_AS(inflated("AwI="), doctest::Contains("before the start"), ml::io_error);
  CHECK_THROWS_WITH_AS(inflated("/f///////////w=="), doctest::Contains("403"), ml::io_error);
}

TEST_CASE("members come back; the same members give the same bytes") {
  const auto bytes = two_members();
  CHECK(bytes == two_members());
  const ml::ZipArchive zip(bytes, "test.zip");
  REQUIRE(zip.entries().size() == 2);
  CHECK(ml::detail::as_text(zip.read(zip.entries()[0])) == "walk");
  CHECK(ml::detail::as_text(zip.stored(*zip.find("a.txt"))) == "walk");
  CHECK(zip.read(*zip.find("folder/b.txt")).empty());
  CHECK(zip.find("b.txt") == nullptr);
  CHECK(ml::ZipArchive(ml::ZipWriter().finish(), "empty").entries().empty());
}

TEST_CASE("names with two dots in them stay in the archive, folders of this name lead out of it") {
  for (const std::string name : {"a..b.npy", "..a", "a..", "a/...", "a../b"}) {
    ml::ZipWriter zip;
    zip.add(name, bytes_of("1"));
    CHECK_MESSAGE(ml::ZipArchive(zip.finish(), "test.zip").entries().size() == 1, name);
  }
  for (const std::string name : {"..", "../a", "a/..", "a/../b"}) {
    ml::ZipWriter zip;
    zip.add(name, bytes_of("1"));
    CHECK_THROWS_WITH_AS(ml::ZipArchive(zip.finish(), "test.zip"), doctest::Contains("leads out"), ml::io_error);
  }
}

TEST_CASE("hostile archives") {
  const auto good = two_members();
  const std::size_t first = directory_entry(good, 0), second = directory_entry(good, 1), end = good.size() - 22;
  auto refused = [](const std::vector<std::byte>& bytes, const char* text) {
    auto read_all = [&] {
      const ml::ZipArchive zip(bytes, "test.zip");
      for (const auto& e : zip.entries()) zip.read(e);
    };
    CHECK_THROWS_WITH_AS(read_all(), doctest::Contains(text), ml::io_error);
  };
  refused(patched(good, first + 16, 1u), "403");                                 // checksum
  refused(patched(good, first + 8, std::uint16_t{1}), "404");                    // encrypted
  refused(patched(good, first + 10, std::uint16_t{12}), "404");                  // bzip2
  refused(patched(good, first + 24, 5u), "403");                                 // two sizes of a stored member
  refused(patched(good, first + 20, std::uint64_t{0x00FFFFFF00FFFFFF}), "402");  // longer than the file
  refused(patched(patched(good, first + 10, std::uint16_t{8}), first + 24, 1u << 30), "405");  // a bomb
  refused(patched(good, first + 46, std::array<char, 5>{'.', '.', '/', 'x', 'y'}), "leads out");
  refused(patched(good, first + 46, std::array<char, 5>{'/', 't', 'm', 'p', '/'}), "leads out");
  refused(patched(good, second + 42, 0u), "403");             // both at the same place
  refused(patched(good, end + 16, 0xFFFFFF00u), "402");       // directory outside of the file
  refused(patched(good, end + 10, std::uint16_t{3}), "403");  // more entries than there are
  refused(patched(good, end + 4, std::uint16_t{1}), "404");   // several parts
  refused({}, "403");
  ml::ZipWriter twice;
  twice.add("a", bytes_of("1"));
  twice.add("a", bytes_of("2"));
  refused(twice.finish(), "two members");
  for (std::size_t n = 0; n < good.size(); ++n) {
    CHECK_THROWS_AS(ml::ZipArchive(std::span(good).first(n), "cut"), ml::io_error);
  }
}

TEST_CASE("one damaged byte never reaches beyond the archive") {
  const auto good = two_members();
  for (std::size_t at = 0; at < good.size(); ++at) {
    for (const int value : {0x00, 0x7F, 0xFF}) {
      const auto bad = patched(good, at, static_cast<std::byte>(value));
      try {
        const ml::ZipArchive zip(bad, "damaged");
        std::size_t size = 0;
        for (const auto& e : zip.entries()) size += zip.read(e).size();
        CHECK(size <= 4);
      } catch (const ml::io_error& e) {
        CHECK(e.id() >= 402);
      }
    }
  }
}
