// The command doctor.
#include <doctest/doctest.h>

#include <motionlang/datasets/annotations.hpp>
#include <motionlang/datasets/humanml3d_folder.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/glb_reader.hpp>
#include <motionlang/formats/glb_writer.hpp>
#include <motionlang/formats/motion_npy.hpp>

#include "../support/synthetic_motion.hpp"
#include "small_workplace.hpp"

TEST_CASE("doctor reports numbers that are not finite; info says what is wrong with binary files") {
  const Workplace w;
  std::filesystem::create_directories(w / "data");
  std::vector<float> joints(2 * 22 * 3, 1);
  joints[70] = std::numeric_limits<float>::quiet_NaN();
  ml::write_npy(w / "data/nan.npy", ml::NpyArray::of(std::span<const float>(joints), {2, 22, 3}));
  const auto seen = w.run({"doctor", "data"});
  CHECK_MESSAGE(contains(seen.text, "nan.npy: not finite: [motionlang.numeric.301]"), seen.text);
  ml::write_file(w / "zeros", std::string(100, '\0'));
  const auto told = w.run({"info", "zeros"});
  CHECK(told.code == 1);
  CHECK_MESSAGE(contains(told.text, "zeros: byte 8"), told.text);
}

TEST_CASE("doctor: finds what is broken in a folder, writes a page and a mended copy") {
  const Workplace w;
  const auto walk = synthetic::walk({.frames = 60, .fps = 30});
  std::filesystem::create_directories(w / "data/deep");
  ml::write_bvh(w / "data/sound.bvh", walk);
  ml::write_bvh(w / "data/deep/large.bvh", walk, {.scale = 10000});
  auto spiked = walk;
  spiked.root[30].x += 0.5;
  ml::write_glb(w / "data/spiked.glb", spiked);
  std::string nan = ml::read_file(w / "data/sound.bvh");
  std::string row = "oops";
  for (int i = 1; i < 3 + 3 * 24; ++i) row += " 0";
  nan.replace(nan.find("MOTION"), std::string::npos, "MOTION\nFrames: 1\nFrame Time: 0.05\n" + row + "\n");
  ml::write_file(w / "data/nan.bvh", nan);
  ml::write_file(w / "data/notes.txt", "no motion");

  const auto seen = w.run({"doctor", "data", "--report", "page.html", "--clean", "clean", "--all"});
  REQUIRE_MESSAGE(seen.code == 0, seen.text);
  for (const char* text :
       {"sound.bvh: good", "deep/large.bvh: scale: ", "x 0.01 (", "spiked.glb spiked: spike: 1 frame",
        "nan.bvh: unreadable: [motionlang.io.403]", "4 motions, 1 without a finding"})
    CHECK_MESSAGE(contains(seen.text, text), text, " in ", seen.text);
  const auto page = ml::read_file(w / "page.html");
  CHECK(contains(page, "4 motions: 1 without a finding, 2 with findings, 1 unreadable."));
  CHECK(contains(page, "<svg"));

  const auto clean = w.run({"doctor", "clean"});
  CHECK_MESSAGE(contains(clean.text, "3 motions, 3 without a finding"), clean.text);
  CHECK(synthetic::largest_distance(ml::read_bvh_motion(w / "clean/deep/large.bvh"),
                                    ml::read_bvh_motion(w / "data/sound.bvh")) < 1e-3);
  // Copies of animations of one name, which is a path besides, stay apart and in the folder.
  std::vector<ml::Motion> two(2, walk);
  two[0].name = two[1].name = "../walk";
  std::filesystem::create_directories(w / "named");
  ml::write_glb(w / "named/a.glb", two);
  CHECK(w.run({"doctor", "named", "--clean", "kept"}).code == 0);
  for (const char* copy : {"kept/a.glb .._walk.bvh", "kept/a.glb .._walk_2.bvh"})
    CHECK_MESSAGE(std::filesystem::exists(w / copy), copy);
  // A copy of a.npz and the file a.npz.bvh, too.
  std::filesystem::create_directories(w / "alike");
  ml::write_amass(w / "alike/a.npz", walk);
  ml::write_bvh(w / "alike/a.npz.bvh", walk);
  CHECK(w.run({"doctor", "alike", "--clean", "both"}).code == 0);
  for (const char* copy : {"both/a.npz.bvh", "both/a.npz_2.bvh"})
    CHECK_MESSAGE(std::filesystem::exists(w / copy), copy);
  const auto over = w.run({"doctor", "data", "--clean", "data/deep/.."});
  CHECK(over.code == 2);
  CHECK_MESSAGE(contains(over.text, "is the folder of the originals"), over.text);
  std::filesystem::create_symlink("loop.bvh", w / "clean/loop.bvh");  // to itself
  std::filesystem::create_directory_symlink(".", w / "clean/again");
  const auto circle = w.run({"doctor", "clean"});
  CHECK(circle.code == 0);
  CHECK_MESSAGE(contains(circle.text, "skipped: clean/loop.bvh: "), circle.text);
  CHECK_MESSAGE(contains(circle.text, "3 motions, 3 without a finding"), circle.text);
  CHECK(w.run({"doctor", "nowhere"}).code == 2);
  std::filesystem::create_directories(w / "empty");
  CHECK(contains(w.run({"doctor", "empty"}).text, "no .bvh, .amc, .npz, .npy, .glb or .vrma file below 'empty'"));
}

TEST_CASE("doctor: a jump tells a wrong frame rate, and the copy has the right one") {
  const Workplace w;
  auto jump = synthetic::jump(60);
  jump.fps = 120;
  std::filesystem::create_directories(w / "data");
  ml::write_bvh(w / "data/a.bvh", jump);
  ml::write_amass(w / "data/b.npz", jump);
  jump.fps = 30;
  ml::write_bvh(w / "data/c.bvh", jump);
  const auto seen = w.run({"doctor", "data", "--clean", "clean"});
  for (const char* text :
       {"2 times too fast, 60 frames per second, not 120", "2 times too slow, 60 frames per second, not 30",
        "     3  fall           bodies fall faster or slower than they do"})
    CHECK_MESSAGE(contains(seen.text, text), text, " in ", seen.text);
  for (const char* copy : {"clean/a.bvh", "clean/b.npz.bvh", "clean/c.bvh"})
    CHECK(ml::read_bvh_motion(w / copy).fps == doctest::Approx(60).epsilon(1e-4));
  CHECK(contains(w.run({"doctor", "clean"}).text, "3 motions, 3 without a finding"));
}

TEST_CASE("doctor: arrays of joints and features except mean and deviation; AMC files with a skeleton from elsewhere") {
  const Workplace w;
  for (const char* folder : {"set", "one", "two"}) std::filesystem::create_directories(w / folder);
  auto walk = synthetic::walk({.frames = 60});
  ml::write_joints_npy(w / "set/joints.npy", walk);
  CHECK(w.run({"convert", "set/joints.npy", "set/rows.npy", "--features", "guoh3d"}).code == 0);
  const std::vector<float> numbers(263, 1), unknown(40);
  ml::write_npy(w / "set/Mean.npy", ml::NpyArray::of(std::span<const float>(numbers), {263}));
  ml::write_npy(w / "set/odd.npy", ml::NpyArray::of(std::span<const float>(unknown), {2, 20}));
  const auto set = w.run({"doctor", "set", "--all"});
  for (const char* text :
       {"joints.npy: good", "rows.npy: good", "odd.npy: unreadable: [motionlang.io.407]", "3 motions, 2 without"})
    CHECK_MESSAGE(contains(set.text, text), text, " in ", set.text);

  const std::string asf =
      ":version 1.10\n:name n\n:units\nmass 1.0\nlength 0.45\nangle deg\n:root\naxis XYZ\norder TX TY TZ RZ RY RX\n"
      "position 0 0 0\norientation 0 0 0\n:bonedata\nbegin\nid 1\nname thigh\ndirection 1 0 0\nlength 2\naxis 0 0 0 "
      "XYZ\n"
      "dof rx\nlimits (-180 180)\nend\n:hierarchy\nbegin\nroot thigh\nend\n";
  const std::string amc = ":FULLY-SPECIFIED\n:DEGREES\n1\nroot 0 1 0 0 0 0\nthigh 10\n2\nroot 0 1 0 0 0 0\nthigh 20\n";
  ml::write_file(w / "one/13_30.amc", amc);
  ml::write_file(w / "body.asf", asf);
  const std::string missing =
      "there is no skeleton one/13.asf, and not exactly one other .asf file beside it; set --asf";
  CHECK(contains(w.run({"doctor", "one"}).text, "unreadable: [motionlang.io.401] one/13_30.amc: " + missing));
  const auto alone = w.run({"convert", "one/13_30.amc", "leg.bvh"});
  CHECK(alone.code == 1);
  CHECK_MESSAGE(contains(alone.text, missing), alone.text);
  CHECK(w.run({"convert", "one/13_30.amc", "leg.bvh", "--asf", "body.asf"}).code == 0);
  const auto given = w.run({"doctor", "one", "--asf", "body.asf", "--all"});
  CHECK_MESSAGE((contains(given.text, "1 motion, ") && !contains(given.text, "unreadable")), given.text);
  ml::write_file(w / "two/13_30.amc", amc);
  ml::write_file(w / "two/body.asf", asf);  // the only one there
  const auto made = w.run({"convert", "two/13_30.amc", "leg.bvh", "--rate", "60"});
  CHECK_MESSAGE(contains(made.text, "leg.bvh: 2 frames at 60 per second, 0.03 s, 2 joints"), made.text);

  std::string smaller = asf;  // for those that have none: others keep their own
  smaller.replace(smaller.find("0.45"), 4, "0.90");
  ml::write_file(w / "smaller.asf", smaller);
  std::filesystem::rename(w / "one", w / "two/one");
  REQUIRE(w.run({"convert", "two", "legs", "--as", ".bvh", "--asf", "smaller.asf"}).code == 0);
  const auto height = [&](const char* file) { return ml::read_bvh_motion(w / file).root_at(0).y; };
  CHECK(height("legs/13_30.bvh") == doctest::Approx(2 * height("legs/one/13_30.bvh")).epsilon(1e-3));
}
