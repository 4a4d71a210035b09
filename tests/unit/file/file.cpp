// Mapped files: who holds which bytes, and what happens to bytes that are forgotten.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

#ifndef _WIN32
#include <sys/stat.h>  // mkfifo
#endif

#include <motionlang/file/file.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

namespace {

std::string numbered(std::size_t size) {
  std::string out(size, ' ');
  for (std::size_t i = 0; i < size; ++i) out[i] = static_cast<char>('a' + i % 23);
  return out;
}
bool holds(const std::shared_ptr<const ml::MappedFile>& file, const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return std::equal(file->bytes().begin(), file->bytes().end(), bytes.begin(), bytes.end());
}

}  // namespace

TEST_CASE("MappedFile: the file that holds some bytes, among several, and nobody for other memory") {
  const TemporaryFolder folder;
  const std::string text = numbered(10000);
  ml::write_file((folder.path / "a").string(), text);
  ml::write_file((folder.path / "b").string(), text);
  ml::write_file((folder.path / "empty").string(), std::string_view());
  const auto a = ml::MappedFile::open(folder.path / "a"), empty = ml::MappedFile::open(folder.path / "empty");
  auto b = ml::MappedFile::open(folder.path / "b");
  CHECK(ml::MappedFile::that_holds(a->bytes()) == a.get());
  CHECK(ml::MappedFile::that_holds(b->bytes().subspan(9999, 1)) == b.get());
  CHECK(ml::MappedFile::that_holds(std::as_bytes(std::span(text))) == nullptr);
  const auto past_the_end = std::span(a->bytes().data(), a->bytes().size() + 1);
  CHECK(ml::MappedFile::that_holds(past_the_end) == nullptr);
  const auto gone = b->bytes();
  b.reset();
  CHECK(ml::MappedFile::that_holds(gone) == nullptr);
  CHECK(ml::MappedFile::that_holds(a->bytes()) == a.get());
}

TEST_CASE("MappedFile: bytes that are put aside are there as long as the mapping, and leave nothing behind") {
  const TemporaryFolder folder;
  const std::string text = numbered(100'000), before = std::filesystem::temp_directory_path();
  const auto bytes = std::as_bytes(std::span(text));
  ::setenv("TMPDIR", folder.path.c_str(), 1);
  auto aside = ml::MappedFile::put_aside(bytes);
  REQUIRE(aside != nullptr);
  CHECK(std::filesystem::is_empty(folder.path));
  aside->forget(aside->bytes());
  CHECK(holds(aside, text));
  CHECK(ml::MappedFile::that_holds(aside->bytes()) == aside.get());
  const auto gone = aside->bytes();
  aside.reset();
  CHECK(ml::MappedFile::that_holds(gone) == nullptr);
  CHECK(ml::MappedFile::put_aside({}) == nullptr);
  ::setenv("TMPDIR", (folder.path / "missing").c_str(), 1);
  CHECK(ml::MappedFile::put_aside(bytes) == nullptr);
  ::setenv("TMPDIR", before.c_str(), 1);
}

TEST_CASE("write_file: the error has the name of the file, not of the temporary file") {
  const TemporaryFolder folder;
  const std::string path = folder.path / "missing" / "a.bvh";
  CHECK_ERROR(ml::write_file(path, std::string_view("a")),
              ("[motionlang.io.401] cannot write " + path + ": No such file or directory").c_str());
}

#ifndef _WIN32
TEST_CASE("write_file: behind a symbolic link that leads to no file yet, the file is made") {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path / "disk");
  std::filesystem::create_symlink("disk/new", folder.path / "link");
  ml::write_file(folder.path / "link", "one");
  CHECK(std::filesystem::is_symlink(folder.path / "link"));
  CHECK(ml::read_file(folder.path / "disk" / "new") == "one");
}

TEST_CASE("write_file: links to links are followed, and not in a circle") {
  const TemporaryFolder folder;
  std::filesystem::create_symlink("second", folder.path / "first");
  std::filesystem::create_symlink("new", folder.path / "second");
  ml::write_file(folder.path / "first", "one");
  CHECK(std::filesystem::is_symlink(folder.path / "second"));
  CHECK(ml::read_file(folder.path / "new") == "one");
  std::filesystem::create_symlink("circle", folder.path / "circle");
  CHECK_ERROR(ml::write_file(folder.path / "circle", "one"), "more than 40 links");
}

TEST_CASE("write_file: permissions of the file that is replaced stay") {
  const TemporaryFolder folder;
  const auto path = folder / "a";
  const auto allowed = [&] { return std::filesystem::status(path).permissions(); };
  ml::write_file(path, "one");
  for (const unsigned mode : {0600U, 0640U, 0664U}) {
    std::filesystem::permissions(path, std::filesystem::perms(mode));
    ml::write_file(path, "two");
    CHECK(allowed() == std::filesystem::perms(mode));
  }
}

TEST_CASE("write_file: a pipe is not replaced") {
  const TemporaryFolder folder;
  const auto pipe = folder.path / "pipe";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  CHECK_ERROR(ml::write_file(pipe, "one"), "it is not a file but a device or a pipe");
  CHECK(std::filesystem::is_fifo(pipe));
}
#endif

TEST_CASE("write_file: behind a symbolic link the file is written, and the link stays") {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path / "disk");
  std::filesystem::create_symlink("disk/a", folder.path / "link");
  ml::write_file(folder / "disk/a", std::string_view("old"));
  ml::write_file(folder / "link", std::string_view("new"));
  CHECK(std::filesystem::is_symlink(folder.path / "link"));
  CHECK(ml::read_file(folder / "disk/a") == "new");
}

TEST_CASE("write_file: names as long as the system takes, in the working folder and elsewhere") {
  const TemporaryFolder folder;
  const std::string longest(255, 'n');
  ml::write_file(folder / longest, "one");
  CHECK(ml::read_file(folder / longest) == "one");
  const auto before = std::filesystem::current_path();
  std::filesystem::current_path(folder.path);
  ml::write_file(longest, "two");
  CHECK(ml::read_file(longest) == "two");
  std::filesystem::current_path(before);
}

TEST_CASE("write_file: two at once leave one of both, whole, and nothing beside it") {
  const TemporaryFolder folder;
  const std::string path = folder.path / "a", first(200'000, 'a'), second(300'000, 'b');
  for (int round = 0; round < 20; ++round) {
    std::thread other([&] { ml::write_file(path, std::string_view(first)); });
    ml::write_file(path, std::string_view(second));
    other.join();
    const std::string there = ml::read_file(path);
    CHECK((there == first || there == second));
  }
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path), {}) == 1);
}

TEST_CASE("MappedFile: what was forgotten takes no memory, and is read from the file again") {
  const TemporaryFolder folder;
  constexpr std::size_t size = std::size_t{64} << 20;
  const std::string text = numbered(size);
  ml::write_file((folder.path / "large").string(), text);
  const auto file = ml::MappedFile::open(folder.path / "large");
  const auto resident = [] {
    std::size_t total = 0, pages = 0;
    std::ifstream("/proc/self/statm") >> total >> pages;
    return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  };
  REQUIRE(holds(file, text));
  const std::size_t before = resident();
  file->forget(file->bytes().subspan(5, size - 10));
  const std::size_t after = resident();
  CHECK(after + size * 9 / 10 < before);
  CHECK(holds(file, text));
  file->forget(file->bytes().first(100));  // no whole page
  file->forget(file->bytes().first(0));
  CHECK(holds(file, text));
}
