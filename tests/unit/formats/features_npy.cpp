// Features of motions as .npy files.
#include <doctest/doctest.h>

#include <motionlang/features/feature_rows.hpp>
#include <motionlang/file/npy.hpp>
#include <motionlang/formats/features_npy.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;

TEST_CASE("features are written at their own rate, or at another") {
  const TemporaryFolder folder;
  const ml::Motion walk = synthetic::walk({.frames = 60, .fps = 30});
  const ml::MotionFeatures& features = ml::motion_features("guoh3d");
  const auto made = ml::write_features_npy(folder / "walk.npy", walk, features);
  CHECK(made.fps == 20);
  CHECK(made.width == 263);
  CHECK(made.seconds() == doctest::Approx(static_cast<double>(made.rows) / 20));
  const auto array = ml::read_npy(folder / "walk.npy");
  CHECK(array.shape == std::vector<ml::Index>{made.rows, 263});
  CHECK(array.to<float>() == made.values);
  const auto rows = ml::rows_of_motion(features, walk, 20);
  CHECK(made.values == std::vector<float>(rows.begin(), rows.end()));
  CHECK(ml::feature_rows(walk, features, 30).fps == 30);
  CHECK_ERROR(ml::write_features_npy("/nowhere/walk.npy", walk, features), "[motionlang.io.401]");
}

TEST_CASE("a motion on other joints gets to those of the features") {
  const ml::MotionFeatures& features = ml::motion_features("guoh3d");
  const ml::Motion walk = synthetic::walk({.frames = 30});
  ml::Motion renamed = walk;
  CHECK(ml::has_joints_of(features, walk));
  CHECK(ml::has_joints_of_arrays(walk));
  CHECK(ml::on_joints_of(features, walk).local == walk.local);
  renamed.skeleton.names[1] = "thigh";
  CHECK_FALSE(ml::has_joints_of(features, renamed));
  CHECK_FALSE(ml::has_joints_of_arrays(renamed));
  CHECK_ERROR(ml::on_joints_of(features, renamed), "[motionlang.config.103]");
}
