// Faults of the motions of a folder, and mended copies.
#include <doctest/doctest.h>

#include <motionlang/core/option_error.hpp>
#include <motionlang/file/file.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/glb_writer.hpp>
#include <motionlang/view/inspect_folder.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
namespace fs = std::filesystem;

TEST_CASE("every motion of a folder is inspected; copies are mended, originals stay") {
  const TemporaryFolder folder;
  fs::create_directories(folder / "data/deep");
  const auto walk = synthetic::walk({.frames = 60, .fps = 30});
  ml::write_bvh(folder / "data/sound.bvh", walk);
  ml::write_bvh(folder / "data/deep/large.bvh", walk, {.scale = 10000});
  const std::vector<ml::Motion> two{walk, walk};
  ml::write_glb(folder / "data/two.glb", two);
  ml::write_file(folder / "data/broken.bvh", std::string_view("HIERARCHY\n"));

  std::string notes;
  std::vector<ml::Index> done;
  const auto report = [&](ml::Index at, ml::Index of) {
    done.push_back(at);
    return of == 4;
  };
  const auto found = ml::inspect_folder(folder / "data", {.clean = folder / "clean", .strips = 1}, &notes, report);
  CHECK(notes.empty());
  CHECK(done == std::vector<ml::Index>{1, 2, 3, 4});
  REQUIRE(found.size() == 5);
  CHECK(found[0].name == "broken.bvh");
  CHECK_MESSAGE(found[0].unreadable.find("[motionlang.io.40") != std::string::npos, found[0].unreadable);
  CHECK(found[1].name == "deep/large.bvh");
  REQUIRE(found[1].findings.size() == 1);
  CHECK(found[1].findings[0].fault == ml::Fault::scale);
  CHECK(found[1].strip.find("<svg") != std::string::npos);
  CHECK(found[2].name == "sound.bvh");
  CHECK(found[2].good());
  CHECK(found[2].strip.empty());
  CHECK(found[2].about == "2.00 s, 30 frames per second, 24 joints");
  CHECK(found[3].name != found[4].name);  // animations of one name
  const std::string lines = ml::describe_inspection(found), all = ml::describe_inspection(found, true);
  CHECK(lines.find("broken.bvh: unreadable: [motionlang.io.40") != std::string::npos);
  CHECK(lines.find("\ndeep/large.bvh: scale: ") != std::string::npos);
  CHECK(lines.find("sound.bvh") == std::string::npos);
  CHECK(all.find("\nsound.bvh: good\n") != std::string::npos);
  CHECK(lines.find("\n\n5 motions, 3 without a finding\n     1  unreadable     the line of the file says why\n") !=
        std::string::npos);
  CHECK(lines.ends_with("     1  scale          the figure is not as tall as a person (`clean` mends)\n"));
  for (const char* copy : {"clean/sound.bvh", "clean/deep/large.bvh"}) CHECK_MESSAGE(fs::exists(folder / copy), copy);
  CHECK(synthetic::largest_distance(ml::read_bvh_motion(folder / "clean/deep/large.bvh"),
                                    ml::read_bvh_motion(folder / "data/sound.bvh")) < 1e-3);
  CHECK(ml::inspect_folder(folder / "clean").size() == 4);

  const auto stop = [](ml::Index, ml::Index) { return false; };
  CHECK_THROWS_AS(ml::inspect_folder(folder / "data", {}, nullptr, stop), ml::cancelled);
  CHECK_THROWS_AS(ml::inspect_files({folder / "data/sound.bvh"}, folder / "data", {.clean = folder / "data"}),
                  ml::option_error);
  fs::create_directories(folder / "empty");
  CHECK_ERROR(ml::inspect_folder(folder / "empty"), "[motionlang.config.101]");
}
