// Motions as clips of a data set in HumanML3D's form.
#include <doctest/doctest.h>

#include <motionlang/datasets/data_set_form.hpp>
#include <motionlang/datasets/humanml3d_clip.hpp>
#include <motionlang/file/id_list.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

TEST_CASE("a clip is added once, and replaced only if asked to") {
  const TemporaryFolder folder;
  const auto data = folder / "data";
  const ml::DataSetForm& form = *ml::find_data_set_form("guoh3d");
  const ml::Motion walk = synthetic::walk({.frames = 60, .fps = 30}), fast = synthetic::walk({.frames = 60, .fps = 20});
  const auto added = ml::add_humanml3d_clip(data, "walk", walk, form);
  CHECK(added.fps == 20);
  CHECK(added.captions == 0);
  CHECK(added.frames > 30);
  ml::add_humanml3d_clip(data, "walk", walk, form);  // the same motion
  ml::add_humanml3d_clip(data, "fast", fast, form);
  CHECK(ml::read_ids(data / "all.txt") == std::vector<std::string>{"walk", "fast"});
  const ml::HumanMl3dFolder read(data);
  CHECK(read.load("walk").frames == added.frames);
  CHECK(ml::is_data_set(data));
  CHECK(ml::data_set_form_of(ml::rows_file(data, "walk")).features == "guoh3d");

  CHECK_ERROR(ml::add_humanml3d_clip(data, "walk", fast, form), "[motionlang.config.102]");
  CHECK(ml::add_humanml3d_clip(data, "walk", fast, form, 0, true).frames == read.load("fast").frames);
  CHECK_ERROR(ml::add_humanml3d_clip(data, "kit", walk, *ml::find_data_set_form("kit")), "[motionlang.config.");
}
