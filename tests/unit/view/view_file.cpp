// Pages and pictures of motions by the extension of the file.
#include <doctest/doctest.h>

#include <motionlang/file/png.hpp>
#include <motionlang/formats/glb_writer.hpp>
#include <motionlang/view/film_strip.hpp>
#include <motionlang/view/view_file.hpp>
#include <motionlang/view/viewer.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

TEST_CASE("the extension says what is written") {
  const TemporaryFolder folder;
  const ml::Motion walk = synthetic::walk({.frames = 8});
  const auto written = [&](const char* name) {
    ml::write_motion_or_view(folder / name, walk);
    return ml::read_file(folder / name);
  };
  CHECK(written("a.html") == ml::viewer_html(walk));
  CHECK(written("a.svg") == ml::film_strip_svg(walk));
  CHECK(written("a.png") == ml::encode_png(ml::film_strip_picture(walk)));
  ml::write_motion(folder / "b.bvh", walk);
  CHECK(written("a.bvh") == ml::read_file(folder / "b.bvh"));
  for (const char* kind : {".html", ".svg", ".png", ".bvh", ".glb"}) {
    const auto bytes = ml::motion_or_view_bytes(kind, walk);
    CHECK(std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()) ==
          written((std::string("a") + kind).c_str()));
  }
  ml::write_view(folder / "c.svg", walk);
  CHECK(ml::read_file(folder / "c.svg") == ml::film_strip_svg(walk));
  CHECK_ERROR(ml::write_view(folder / "c.bvh", walk), "[motionlang.config.103]");
  CHECK_ERROR(ml::write_motion_or_view(folder / "c.fbx", walk), "[motionlang.config.103]");
  CHECK_ERROR(ml::write_motion_or_view("/nowhere/c.html", walk), "[motionlang.io.401]");
}

TEST_CASE("several motions go into one file") {
  const TemporaryFolder folder;
  const std::vector<ml::Motion> two{synthetic::walk({.frames = 3}), synthetic::walk({.frames = 5})};
  CHECK(ml::holds_together("a.glb", two));
  CHECK(ml::holds_together("a.html", two));
  CHECK_FALSE(ml::holds_several("a.bvh"));
  ml::write_motions(folder / "a.glb", two);
  CHECK(ml::read_motions(folder / "a.glb").size() == 2);
  ml::write_motions(folder / "a.html", two);
  CHECK(std::filesystem::file_size(folder / "a.html") > 10'000);
  CHECK_ERROR(ml::write_motions(folder / "a.bvh", two), "[motionlang.config.103]");
  auto others = two;
  others[1].skeleton.offsets[1].x += 0.1;
  CHECK_FALSE(ml::holds_together("a.glb", others));
}
