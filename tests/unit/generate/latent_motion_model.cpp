#include <motionlang/generate/latent_motion_model.hpp>

#include <doctest/doctest.h>

#include "../../support/check_error.hpp"
#include "fake_models.hpp"

namespace ml = motionlang;

TEST_CASE("a line between two motions begins and ends with those of either alone") {
  const fake::Latent model;
  CHECK(model.latent() == &model);
  CHECK(fake::Model().latent() == nullptr);
  const ml::Timeline from = ml::whole_body_timeline("0", 30), to = ml::whole_body_timeline("1", 30);
  const auto line = model.between(from, to, 3, {.seed = 4});
  REQUIRE(line.size() == 3);
  CHECK(line[0].root == ml::generate_motion(model, from, {.seed = 4}).root);
  CHECK(line[2].root == ml::generate_motion(model, to, {.seed = 4}).root);
  CHECK(line[1].root == ml::generate_motion(model, ml::whole_body_timeline("0.5", 30), {.seed = 4}).root);
  CHECK_ERROR(model.between(from, to, 1, {}), "[motionlang.config.101] 1 motion from one text");
  CHECK_ERROR(model.between(from, to, 3, {.noise = "n"}), "[motionlang.config.102] `noise` is for diffusion models");
}

TEST_CASE("a denoised motion is where it was, in parts if it is long, at its own rate") {
  const fake::Latent model;
  for (const int frames : {12, 20, 21, 55}) {
    CAPTURE(frames);
    ml::Motion walk = synthetic::walk({.frames = frames, .turn = 0.4});
    walk.name = "mine";
    const ml::Motion out = model.denoised(walk);
    CHECK(out.name == "mine");
    REQUIRE(out.frames() == walk.frames());
    CHECK(synthetic::largest_distance(out, walk) < 1e-6);
  }
  const ml::Motion fast = synthetic::walk({.frames = 60, .fps = 60});
  CHECK(model.denoised(fast).fps == 60);
}
