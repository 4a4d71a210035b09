#include <motionlang/file/output_folder.hpp>

#include <doctest/doctest.h>
#include <unistd.h>

#include <motionlang/file/file.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
namespace fs = std::filesystem;

TEST_CASE("a folder for results is there before the work, and goes again if it stays empty") {
  const TemporaryFolder folder;
  {
    const ml::OutputFolder out("`out`", folder / "a/b");
    CHECK(fs::is_directory(folder / "a/b"));
  }
  CHECK_FALSE(fs::exists(folder / "a"));
  {
    const ml::OutputFolder out("`out`", folder / "a/b");
    ml::write_file(folder / "a/result", std::string_view("x"));
  }
  CHECK(fs::exists(folder / "a/result"));
  CHECK_FALSE(fs::exists(folder / "a/b"));  // nothing was written there
  { const ml::OutputFolder out("`out`", folder / "a"); }
  CHECK(fs::exists(folder / "a"));  // it was there before

  ml::write_file(folder / "file", std::string_view("x"));
  CHECK_ERROR(ml::OutputFolder("`out`", folder / "file/below"), "[motionlang.io.401] `out` ");
  if (::geteuid() != 0) {  // root may write anywhere
    fs::permissions(folder / "a", fs::perms::owner_read | fs::perms::owner_exec);
    CHECK_ERROR(ml::make_output_folder("--out", folder / "a"), "[motionlang.io.401] --out ");
    fs::permissions(folder / "a", fs::perms::owner_all);
  }
}

TEST_CASE("a file for results needs its folder") {
  const TemporaryFolder folder;
  ml::require_folder_of("here");
  ml::require_folder_of(folder / "here");
  CHECK_ERROR(ml::require_folder_of(folder / "nowhere/here"), "nowhere/here: there is no folder ");
}
