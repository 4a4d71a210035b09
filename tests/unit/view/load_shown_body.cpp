// Motions on the free body, and on a body of the user's own.
#include <motionlang/view/load_shown_body.hpp>

#include <doctest/doctest.h>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/view/body_view.hpp>
#include <motionlang/view/shown_body.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"

namespace ml = motionlang;
namespace fs = std::filesystem;
using B = ml::EigenBackend<float>;

TEST_CASE("the free body shows any joints in three formats") {
  const TemporaryFolder folder;
  const auto body = ml::load_shown_body<B>({.file = "free"});
  const ml::Motion walk = synthetic::walk({.frames = 3});
  CHECK(body->takes_any_joints());
  CHECK(body->has_joints_of(walk));
  const ml::BodyFiles pictures = body->write(folder / "walk.obj", {walk});
  CHECK(pictures.files == 3);
  CHECK(pictures.vertices > 24);
  int objects = 0;
  for (const auto& entry : fs::directory_iterator(folder.path)) objects += entry.path().extension() == ".obj";
  CHECK(objects == 3);
  CHECK(body->write(folder / "walk.glb", {walk, walk}).files == 1);
  CHECK(ml::read_file(folder / "walk.glb").starts_with("glTF"));
  CHECK(body->write(folder / "walk.html", {walk}).body == "the free body");
  CHECK(fs::exists(folder / "walk.html"));
  CHECK_ERROR(body->write(folder / "walk.bvh", {walk}), "[motionlang.config.103]");
  CHECK_ERROR(body->write(folder / "none.glb", {}), "[motionlang.config.101]");
  CHECK_ERROR(ml::load_shown_body<B>({.file = (folder / "nobody.npz").string()}), "[motionlang.io.401]");
}
