#include <motionlang/generate/generate_motion.hpp>
#include <motionlang/generate/generate_options.hpp>
#include <motionlang/generate/motion_model.hpp>

#include <doctest/doctest.h>

#include <motionlang/generate/finish_motion.hpp>

#include "../../support/check_error.hpp"
#include "fake_models.hpp"

namespace ml = motionlang;

namespace {

const ml::Timeline walk = ml::whole_body_timeline("walk", 30);

/// The id of the option_error that a model throws for options; 0 for none. Nothing is made then.
int refused(const fake::Model& model, const ml::GenerateOptions& options) {
  const int before = model.calls;
  try {
    ml::generate_motion(model, walk, options);
    return 0;
  } catch (const ml::option_error& e) {
    CHECK(model.calls == before);
    return e.id();
  }
}

}  // namespace

TEST_CASE("options that a model does not take are refused before anything is made") {
  fake::Model plain, diffusion, latent;
  diffusion.diffusion_steps = 10, diffusion.timelines = true, latent.latents = true;
  using Sampler = ml::SamplingOptions::Sampler;
  CHECK(refused(plain, {.seed = 7, .overlap = 1, .cut_texts = false, .smooth = false}) == 0);
  for (const ml::GenerateOptions& o :
       {ml::GenerateOptions{.noise = "n"}, ml::GenerateOptions{.record = "r"}, ml::GenerateOptions{.reuse = "r"},
        ml::GenerateOptions{.keep = ml::KeptClip{}}, ml::GenerateOptions{.steps = 3},
        ml::GenerateOptions{.sampler = Sampler::ddim}, ml::GenerateOptions{.guidance = 2},
        ml::GenerateOptions{.noise_scale = ml::NoiseScale::posterior_std},
        ml::GenerateOptions{.mode = ml::StmcMode::sinc}})
    CHECK((refused(plain, o) == 102 && refused(latent, o) == 102 && refused(diffusion, o) == 0));
  CHECK(refused(diffusion, {.steps = 10}) == 0);
  CHECK(refused(diffusion, {.steps = 11}) == 105);
  CHECK(refused(latent, {.fact = 0.5}) == 0);
  CHECK(refused(plain, {.fact = 0.5}) == 102);
  CHECK_ERROR(ml::check_options(diffusion, {.steps = 11}), "11 steps are asked for, this model has 10");
  CHECK_ERROR(ml::check_options(plain, {.fact = 1}), "this is a fake model, which draws none");
}

TEST_CASE("a model that makes motions alone: noise by seed and place, finished, with progress") {
  const fake::Latent model;
  const std::vector<ml::Timeline> two{ml::whole_body_timeline("0.3", 30), ml::whole_body_timeline("0.3", 30)};
  ml::Index calls = 0;
  auto progress = [&](ml::Index done, ml::Index total) { return ++calls == done && total == 2; };
  const ml::GenerateOptions raw{
      .seed = 5, .smooth = false, .fix_feet = false, .fix_floor = false, .progress = progress};
  const auto made = ml::generate_motions(model, two, raw);
  CHECK(calls == 2);
  CHECK(made[0].root != made[1].root);
  CHECK(ml::generate_motion(model, two[0], {.seed = 5, .smooth = false, .fix_feet = false, .fix_floor = false}).root ==
        made[0].root);
  const ml::Motion finished = ml::generate_motion(model, two[0], {.seed = 5});
  CHECK(finished.local != made[0].local);
  const ml::Motion expected = ml::finish_motion(made[0], {});
  CHECK((finished.local == expected.local && finished.root == expected.root));
  auto stop = [](ml::Index, ml::Index) { return false; };
  CHECK_THROWS_AS(ml::generate_motions(model, two, {.progress = stop}), ml::cancelled);
}

TEST_CASE("the only text of a timeline, and the number of an action") {
  CHECK(ml::only_text(walk).text == "walk");
  ml::Timeline two = walk;
  two.intervals.push_back(two.intervals.front());
  CHECK_ERROR(ml::only_text(two), "[motionlang.timeline.509] 2 texts in a timeline");
  const std::vector<std::string> labels{"walk", "7", "run"};
  CHECK(ml::action_of("run", labels, 3) == 2);
  CHECK(ml::action_of("7", labels, 3) == 1);  // a name before a number
  CHECK(ml::action_of("0", labels, 3) == 0);
  for (const char* wrong : {"fly", "3", "-1", "1x", ""})
    CHECK_ERROR(ml::action_of(wrong, labels, 3), "is not one of 0 ... 2; they are called walk, 7, run");
  CHECK_ERROR(ml::action_of("fly", {}, 3), "[motionlang.config.103] action 'fly' is not one of 0 ... 2");
}
