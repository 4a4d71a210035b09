// The actions and clips of an ACTOR, and the classifiers that fit it.
#include <doctest/doctest.h>

#include <motionlang/weights/actor_model.hpp>

#include "../../support/check_error.hpp"

namespace ml = motionlang;

TEST_CASE("actions have the names of their data set, else their numbers") {
  const auto names = ml::class_names("humanact12", 12);
  REQUIRE(names.size() == 12);
  CHECK(names[0] == "warm_up");
  CHECK(names[1] == "walk");
  CHECK(ml::class_names("", 3) == std::vector<std::string>{"0", "1", "2"});
}

TEST_CASE("a classifier's numbers are found by name; other actions are refused") {
  const std::vector<std::string> model{"walk", "jump", "sit"}, classifier{"sit", "walk", "jump"}, fewer{"sit", "walk"};
  CHECK(ml::numbers_of(model, classifier) == std::vector<ml::Index>{1, 2, 0});
  CHECK_ERROR(ml::numbers_of(model, fewer), "[motionlang.config.102] model and classifier have different labels");
}

TEST_CASE("a classifier may read less than a model makes, but not more, and at the same rate") {
  const ml::ActorClipsConfig model;
  ml::ActorClipsConfig seen = model;
  CHECK_NOTHROW(ml::require_same_clips(model, seen));
  seen.translation = false;
  CHECK_NOTHROW(ml::require_same_clips(model, seen));
  CHECK_ERROR(ml::require_same_clips(seen, model), "[motionlang.config.102]");
  CHECK_ERROR(ml::require_same_rows(model, seen), "[motionlang.config.102]");
  seen = model;
  seen.fps = model.fps + 1;
  CHECK_ERROR(ml::require_same_clips(model, seen), "[motionlang.config.102]");
  CHECK_NOTHROW(ml::require_same_rows(model, seen));  // the rate is not in the rows
}

TEST_CASE("a published model says how its clips are made; one without the rotation of joint 0 is refused") {
  ml::ActorConfig sizes;
  sizes.num_classes = 2, sizes.num_frames = 60;
  ml::ActorFeatureOptions features;
  const auto file = ml::published_actor_file(sizes, features, {.step = 3}, ml::ActorPoints::smpl, {}, "opt.yaml");
  CHECK(file.labels == std::vector<std::string>{"0", "1"});
  CHECK(file.config.clips.num_frames == 60);
  CHECK(file.config.clips.sampling_step == 3);
  CHECK(file.config.clips.camera);
  CHECK(file.config.losses.points == "smpl");
  features.global = false;
  const auto positions = ml::published_actor_file(sizes, std::nullopt, {}, ml::ActorPoints::smpl, {}, "opt.yaml");
  CHECK(positions.config.clips.pose == "xyz");
  CHECK(positions.config.clips.width() == 72);
  CHECK_ERROR(ml::published_actor_file(sizes, features, {}, ml::ActorPoints::smpl, {}, "opt.yaml"),
              "[motionlang.config.102] opt.yaml: glob is false");
}
