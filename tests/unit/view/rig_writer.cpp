// The writer of motions on a character: what it writes, what it reports, and what it refuses.
#include <doctest/doctest.h>

#include <motionlang/file/file.hpp>
#include <motionlang/formats/motion_file.hpp>
#include <motionlang/view/rig_viewer.hpp>
#include <motionlang/view/rig_writer.hpp>

#include "../../support/check_error.hpp"
#include "../../support/rigs.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

TEST_CASE("motions go into the character's file or onto a page, with a report") {
  const TemporaryFolder folder;
  const std::string character = (folder / "rig.glb").string();
  const auto bytes = rigs::glb_of(rigs::skeleton_of(ml::skeleton_table("Unreal 4"), 0));
  ml::write_file(character, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  const ml::Motion walk = synthetic::walk({.frames = 5});
  const std::span<const ml::Motion> motions(&walk, 1);
  const ml::RigWriter write = ml::rig_writer({.file = character});
  const std::string result = (folder / "walk.glb").string();
  const std::string report = write(result, motions);
  CHECK(report.starts_with(result + " on " + character + "\n"));
  CHECK(report.find("own skeleton") == std::string::npos);
  const auto written = ml::read_motions(result);
  REQUIRE(written.size() == 2);
  CHECK(written[0].name == "idle");  // of the character
  CHECK(written[1].name == "walk");
  const auto on_rig = ml::motions_on_rig(ml::GlbRig::open(character), motions).motions;
  CHECK(write(folder / "again.glb", on_rig).ends_with("all joints follow: it is the motion's own skeleton\n"));

  write(folder / "walk.html", motions);
  CHECK(ml::read_file(folder / "walk.html") == ml::rig_viewer_html(ml::GlbRig::open(character), motions));

  // The result as the next character: its animations stay, or are dropped.
  ml::rig_writer({.file = result})(folder / "both.glb", motions);
  ml::rig_writer({.file = result, .drop_animations = true})(folder / "one.glb", motions);
  CHECK(ml::read_motions(folder / "both.glb").size() == 3);
  CHECK(ml::read_motions(folder / "one.glb").size() == 1);

  CHECK(!ml::rig_writer({}));
  CHECK_ERROR(write(folder / "walk.bvh", motions), "a character (`rig`) is written to .glb and .html, not '.bvh'");
  CHECK_ERROR(write(result, {}), "no motion");
  CHECK_ERROR(ml::rig_writer({.file = "nowhere.glb"}), "[motionlang.io.401]");
}
