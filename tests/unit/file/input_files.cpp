// Results that would take the place of what is read.
#include <doctest/doctest.h>

#include <motionlang/file/file.hpp>
#include <motionlang/file/input_files.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
namespace fs = std::filesystem;

TEST_CASE("an input is found by whatever name") {
  const TemporaryFolder folder;
  fs::create_directories(folder / "sub");
  ml::write_file(folder / "in.bvh", std::string_view("x"));
  ml::write_file(folder / "other.bvh", std::string_view("x"));
  fs::create_hard_link(folder / "in.bvh", folder / "hard.bvh");
  fs::create_symlink(folder / "in.bvh", folder / "soft.bvh");
  ml::InputFiles inputs{folder / "in.bvh", ""};
  for (const char* name : {"in.bvh", "hard.bvh", "soft.bvh", "sub/../in.bvh"})
    CHECK_MESSAGE(inputs.has(folder / name), name);
  for (const char* name : {"other.bvh", "new.bvh", "in.glb"}) CHECK_MESSAGE(!inputs.has(folder / name), name);
  CHECK(!inputs.has(""));
  CHECK_THROWS_AS(inputs.refuse(folder / "hard.bvh"), ml::option_error);
  CHECK_ERROR(inputs.refuse(folder / "in.bvh"), "in.bvh is an input: name another file for the result");
  inputs.refuse(folder / "new.bvh");
  inputs.add(folder / "new.bvh");  // is not there yet
  CHECK(inputs.has(folder / "new.bvh"));
  const ml::InputFiles several(std::vector<std::string>{(folder / "other.bvh").string()});
  CHECK(several.has(folder / "other.bvh"));
}
