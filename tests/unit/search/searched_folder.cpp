// A folder that is searched while its files come and go.
#include <motionlang/search/searched_folder.hpp>

#include <doctest/doctest.h>

#include <motionlang/file/file.hpp>
#include <motionlang/search/motion_index_file.hpp>

#include "../../support/check_error.hpp"
#include "../../support/speed_encoder.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"
#include "../../support/threads.hpp"

namespace ml = motionlang;
namespace fs = std::filesystem;

namespace {

void put(const fs::path& file, double steps_per_second) {
  fs::create_directories(file.parent_path());
  ml::write_motion(file, synthetic::walk({.frames = 100, .fps = 20, .steps_per_second = steps_per_second}));
}
std::string best(ml::SearchedFolder& folder, const std::string& text) {
  const auto found = folder.find(text, 1).moments;
  return found.empty() ? "" : found.front().file;
}

}  // namespace

TEST_CASE("a search reads what is new and forgets what is gone") {
  const TemporaryFolder place;
  const auto encoder = std::make_shared<SpeedEncoder>();
  ml::SearchedFolder folder(place.path, encoder);
  CHECK(folder.find("walk 3", 5).moments.empty());
  put(place / "slow.bvh", 1);
  CHECK(best(folder, "walk 9") == "slow.bvh");
  put(place / "more" / "fast.bvh", 3);
  int steps = 0;
  const auto count = [&](ml::Index done, ml::Index total) {
    CHECK(done <= total);
    return ++steps > 0;
  };
  const ml::FolderAnswer both = folder.find("walk 9", 5, count);
  CHECK(steps == 1);
  CHECK(both.clips == 2);
  REQUIRE(!both.moments.empty());
  CHECK(both.moments.front().file == "more/fast.bvh");
  CHECK(both.moments.front().end > both.moments.front().start);
  CHECK(both.moments.front().score > 0.5);
  CHECK(best(folder, "walk 0") == "slow.bvh");
  CHECK(encoder->asked == 2);  // each file once
  fs::remove(place / "more" / "fast.bvh");
  CHECK(best(folder, "walk 9") == "slow.bvh");
  ml::write_file(place / "broken.bvh", "nothing");
  CHECK(folder.find("walk 9", 1).skipped == 1);
}

TEST_CASE("a moment comes with the motion around it, as far as there is some") {
  const TemporaryFolder place;
  put(place / "walk.bvh", 1);
  const ml::SearchedFolder folder(place.path, std::make_shared<SpeedEncoder>());
  const auto piece = folder.piece({.file = "walk.bvh", .start = 1, .end = 2}, 0.5);
  CHECK(piece.motion.frames() == 40);
  CHECK(piece.start == doctest::Approx(0.5));
  CHECK(piece.end == doctest::Approx(1.5));
  const ml::Motion whole = ml::read_motions(place / "walk.bvh").front();
  CHECK(norm(piece.motion.root_at(10) - whole.root_at(20)) == 0);
  const auto at_start = folder.piece({.file = "walk.bvh", .start = 0.25, .end = 1}, 2);
  CHECK(at_start.start == doctest::Approx(0.25));
  CHECK(at_start.motion.frames() == 60);
  for (const char* file : {"", "none.bvh", "../walk.bvh", "/etc/passwd", "a/../../walk.bvh"})
    CHECK_ERROR(folder.piece({.file = file, .end = 1}), "there is no such motion in the folder");
  CHECK_ERROR(folder.piece({.file = "walk.bvh", .animation = "dance", .end = 1}), "no motion 'dance'");
}

TEST_CASE("links are not followed") {
  const TemporaryFolder place;
  put(place / "elsewhere" / "fast.bvh", 3);
  put(place / "project" / "slow.bvh", 1);
  fs::create_symlink(place / "elsewhere" / "fast.bvh", place / "project" / "link.bvh");
  fs::create_directory_symlink(place / "elsewhere", place / "project" / "more");
  const auto encoder = std::make_shared<SpeedEncoder>();
  ml::SearchedFolder folder(place / "project", encoder);
  CHECK(folder.find("walk 9", 9).clips == 1);
  CHECK(encoder->asked == 1);
  CHECK_ERROR(folder.piece({.file = "link.bvh", .end = 1}), "no such motion");
  CHECK_ERROR(folder.piece({.file = "more/fast.bvh", .end = 1}), "no such motion");
}

TEST_CASE("an index that is a link is neither read nor written, and a licence that is a link is not read") {
  const TemporaryFolder place;
  put(place / "project" / "slow.bvh", 1);
  fs::create_directories(place / "elsewhere");
  ml::write_file(place / "elsewhere" / "secret.txt", "a secret\n");
  const fs::path own = place / "project" / ".motionlang.index";
  fs::create_symlink(place / "elsewhere" / "new.index", own);
  fs::create_symlink(place / "elsewhere" / "secret.txt", place / "project" / "LICENSE");
  const auto encoder = std::make_shared<SpeedEncoder>();
  ml::SearchedFolder linked(place / "project", encoder, {.index = own});
  CHECK(linked.find("walk 9", 9).clips == 1);
  CHECK(!fs::exists(place / "elsewhere" / "new.index"));

  fs::remove(own);
  ml::SearchedFolder folder(place / "project", encoder, {.index = own});
  CHECK(folder.find("walk 9", 9).clips == 1);
  const ml::MotionIndex kept = ml::read_motion_index(own);
  REQUIRE(kept.count() == 1);
  CHECK(kept.clips().front().license.empty());
}

TEST_CASE("vectors are kept in a file, unless it is of another model, damaged or names other folders") {
  const TemporaryFolder place;
  const fs::path project = place / "project", index = project / ".index";
  put(project / "slow.bvh", 1);
  put(place / "elsewhere" / "fast.bvh", 3);
  const auto asked = [&](const std::string& expected) {
    const auto encoder = std::make_shared<SpeedEncoder>();
    ml::SearchedFolder folder(project, encoder, {.index = index});
    CHECK(best(folder, "walk 9") == expected);
    return int(encoder->asked);
  };
  CHECK(asked("slow.bvh") == 1);
  CHECK(asked("slow.bvh") == 0);
  ml::write_file(index, "damaged");
  CHECK(asked("slow.bvh") == 1);
  ml::IndexModel other = ml::index_model(SpeedEncoder());
  other.id = "another";
  ml::write_motion_index(index, ml::MotionIndex(other));
  CHECK(asked("slow.bvh") == 1);
  const SpeedEncoder encoder;
  ml::MotionIndex foreign(ml::index_model(encoder));
  ml::update_index(foreign, place / "elsewhere", encoder);
  ml::write_motion_index(index, foreign);
  CHECK(asked("slow.bvh") == 1);  // the clip elsewhere is not found
}

TEST_CASE("a search that is stopped goes on from there") {
  const TemporaryFolder place;
  const Threads two(2);
  for (int i = 0; i < 40; ++i) put(place / ("walk" + std::to_string(i) + ".bvh"), 1 + 0.05 * i);
  const auto encoder = std::make_shared<SpeedEncoder>();
  ml::SearchedFolder folder(place.path, encoder, {.index = place / ".index"});
  const auto stop = [](ml::Index, ml::Index) { return false; };
  CHECK_THROWS_AS(folder.find("walk 1", 1, stop), ml::cancelled);
  const int some = encoder->asked;
  CHECK(some > 0);
  CHECK(some < 40);
  CHECK(ml::read_motion_index(place / ".index").count() == some);
  CHECK(folder.find("walk 1", 1).clips == 40);
  CHECK(encoder->asked == 40);
}

TEST_CASE("a folder and an encoder have to be there") {
  const TemporaryFolder place;
  CHECK_THROWS_AS(ml::SearchedFolder(place / "none", std::make_shared<SpeedEncoder>()), ml::io_error);
  CHECK_THROWS_AS(ml::SearchedFolder(place.path, nullptr), ml::config_error);
}
