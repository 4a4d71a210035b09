#include <motionlang/generate/judged_prompts.hpp>

#include <doctest/doctest.h>

#include "../../support/check_error.hpp"
#include "fake_models.hpp"

namespace ml = motionlang;

namespace {

bool does(const ml::Motion& motion, const std::string& prompt) {
  for (const ml::JudgedPrompt& p : ml::judged_prompts()) {
    if (p.text == prompt) return p.done(ml::measure_for_prompts(motion));
  }
  FAIL("no such prompt: ", prompt);
  return false;
}

}  // namespace

TEST_CASE("a walk does what the prompts of walking say, and no other") {
  CHECK(ml::judged_prompts().size() == 12);
  const ml::Motion walk = synthetic::walk({.frames = 80});
  CHECK(does(walk, "walk forward"));
  for (const char* other : {"run forward", "walk backwards", "stand still", "turn left", "turn right", "sit down",
                            "raise both arms", "jump forward", "bend forward"})
    CHECK_FALSE(does(walk, other));
  const auto m = ml::measure_for_prompts(walk);
  CHECK((m.forward > 2 && m.speed > 0.5 && std::abs(m.turned) < 20));
  CHECK(does(synthetic::walk({.frames = 60, .turn = 0.5}), "turn left"));
  CHECK(does(synthetic::walk({.frames = 60, .turn = -0.5}), "turn right"));
}

TEST_CASE("a model is judged by all prompts with several seeds") {
  const fake::Model model;
  const ml::Judgement j = ml::judge(model, {}, 3);
  CHECK(model.calls == 3);
  CHECK(j.motions() == 36);
  CHECK(j.results.size() == 12);
  CHECK(j.results[0].size() == 3);
  std::size_t done = 0;
  for (std::size_t i = 0; i < 12; ++i) done += j.done(i);
  CHECK(j.done() == done);
  CHECK(ml::mean_distance(j, j) == 0);
  CHECK(ml::mean_distance(j, ml::Judgement{}, 36) == 0);
  ml::Judgement moved = j;
  for (auto& motion : moved.positions) {
    for (auto& p : motion) p.y += 0.25;
  }
  CHECK(std::abs(ml::mean_distance(j, moved) - 0.25) < 1e-12);
  CHECK_ERROR(ml::judge(model, {}, 0), "[motionlang.config.101] judge: 0 seeds");
}
