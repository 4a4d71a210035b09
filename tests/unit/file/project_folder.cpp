// A folder that is read and written by names alone.
#include <motionlang/file/project_folder.hpp>

#include <doctest/doctest.h>

#include <set>

#include <motionlang/file/file.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

namespace {

bool ends_well(std::string_view name) { return name.ends_with(".txt"); }
std::span<const std::byte> bytes(std::string_view text) { return std::as_bytes(std::span(text)); }

}  // namespace

TEST_CASE("files are written, listed and read by their names") {
  const TemporaryFolder place;
  const ml::ProjectFolder folder(place.path, ends_well);
  CHECK(folder.names().empty());
  folder.write("b.txt", bytes("two"));
  folder.write("a.txt", bytes("one"));
  folder.write("a.txt", bytes("one more"));
  ml::write_file(place / "c.exe", std::string_view("no"));
  std::filesystem::create_directory(place / "d.txt");
  CHECK(folder.names() == std::vector<std::string>{"a.txt", "b.txt"});
  CHECK(folder.read("a.txt", 8) == "one more");
  CHECK_THROWS_AS(folder.read("a.txt", 7), ml::io_error);
  CHECK_THROWS_AS(folder.read("none.txt", 7), ml::io_error);
  CHECK_THROWS_AS(folder.read("d.txt", 7), ml::io_error);
  CHECK_THROWS_AS(folder.write("d.txt", bytes("x")), ml::io_error);
  CHECK_THROWS_AS(folder.read("c.exe", 7), ml::config_error);
  CHECK_THROWS_AS(ml::ProjectFolder(place / "nowhere", ends_well), ml::io_error);
}

TEST_CASE("a file is overwritten only by somebody who knows its contents") {
  const TemporaryFolder place;
  const ml::ProjectFolder folder(place.path, ends_well);
  const std::string one = ml::ProjectFolder::mark(bytes("one")), two = ml::ProjectFolder::mark(bytes("two"));
  CHECK(one.size() == 16);
  CHECK(one != two);
  // Two changes 32 bytes apart, in the highest bytes of words: they once kept the mark.
  std::string text(91, 'a');
  std::set<std::string> marks{ml::ProjectFolder::mark(bytes(text))};
  for (char first = '0'; first <= 'z'; ++first) {
    for (char second = '0'; second <= 'z'; ++second) {
      text[7] = first, text[39] = second;
      marks.insert(ml::ProjectFolder::mark(bytes(text)));
    }
  }
  CHECK(marks.size() == 75 * 75);                            // the first text is one of them
  CHECK(folder.write_over("a.txt", bytes("one"), "", 100));  // there is none
  for (const std::string& wrong : {two, std::string()}) CHECK_FALSE(folder.write_over("a.txt", bytes("x"), wrong, 100));
  CHECK_FALSE(folder.write_over("a.txt", bytes("x"), one, 2));
  CHECK(folder.read("a.txt", 100) == "one");
  CHECK(folder.write_over("a.txt", bytes("two"), one, 100));
  CHECK(folder.read("a.txt", 100) == "two");
  std::filesystem::remove(place / "a.txt");
  CHECK(folder.write_over("a.txt", bytes("one"), two, 100));  // nothing is lost
  std::filesystem::create_directory(place / "d.txt");
  CHECK_THROWS_AS(folder.write_over("d.txt", bytes("x"), "", 100), ml::io_error);
  CHECK_THROWS_AS(folder.write_over("c.exe", bytes("x"), "", 100), ml::config_error);
}

TEST_CASE("nothing outside is reached, by names or by links") {
  const TemporaryFolder place;
  std::filesystem::create_directory(place / "in");
  ml::write_file(place / "secret.txt", std::string_view("secret"));
  const ml::ProjectFolder folder(place / "in", ends_well);
  for (const std::string& name : {std::string("../secret.txt"), (place / "secret.txt").string(),
                                  std::string("x/../../secret.txt"), std::string("./secret.txt")}) {
    CHECK_THROWS_AS(folder.read(name, 100), ml::config_error);
    CHECK_THROWS_AS(folder.write(name, bytes("lost")), ml::config_error);
  }
  std::filesystem::create_symlink(place / "secret.txt", place / "in/link.txt");
  std::filesystem::create_symlink(place / "new.txt", place / "in/dangling.txt");
  CHECK(folder.names().empty());
  for (const char* name : {"link.txt", "dangling.txt"}) {
    CHECK_THROWS_AS(folder.read(name, 100), ml::io_error);
    CHECK_THROWS_AS(folder.write(name, bytes("lost")), ml::io_error);
  }
  CHECK(ml::read_file(place / "secret.txt") == "secret");
  CHECK_FALSE(std::filesystem::exists(place / "new.txt"));
}
