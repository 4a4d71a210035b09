#include <motionlang/generate/reuse_notes.hpp>

#include <doctest/doctest.h>

#include <motionlang/file/file.hpp>

#include "../../support/check_error.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

namespace {

bool has(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

}  // namespace

TEST_CASE("the record of a folder") {
  const TemporaryFolder folder;
  CHECK(ml::find_record(folder / "any.file") == folder / "any.file");
  CHECK_ERROR(ml::find_record(folder.path), ": 0 files *.steps.safetensors, which a run with `record` writes");
  ml::write_file(folder / "walk.safetensors", std::string_view("x"));
  ml::write_file(folder / "walk.steps.safetensors", std::string_view("x"));
  CHECK(ml::find_record(folder.path) == folder / "walk.steps.safetensors");
  ml::write_file(folder / "run.steps.safetensors", std::string_view("x"));
  CHECK_ERROR(ml::find_record(folder.path), "[motionlang.io.401]");
  CHECK_ERROR(ml::find_record(folder.path), "2 files *.steps.safetensors; name one of them");
}

TEST_CASE("what a run says about what it reused") {
  const ml::StmcReuse exact{.frames = 100, .kept = 60, .work = 30, .whole_work = 120, .steps = 20};
  const std::string whole = ml::reuse_notes(exact, {});
  CHECK(has(whole, "60 of 100 frames were reused; 25 % of the work of a whole run\n"));
  CHECK(has(whole, "equals that of a whole run, bit for bit\n"));
  CHECK_FALSE(has(whole, "nothing could be reused"));

  ml::StmcReuse other = exact;
  other.exact = false, other.everywhere = 7;
  CHECK(has(ml::reuse_notes(other, {}), "the reused run was made with `keep_beyond`\n"));
  const std::string kept = ml::reuse_notes(other, 1.5);
  CHECK(has(kept, "frames further than 1.50 s from an edit were kept (`keep_beyond`)\n"));
  CHECK(has(kept, "after step 7 of 20 nothing could be reused"));
  CHECK(has(ml::reuse_notes({}, {}), "0 of 0 frames were reused; 0 % of"));  // no work at all
}
