#include <motionlang/file/file.hpp>
#include <motionlang/generate/judged_prompts.hpp>
#include <motionlang/generate/judged_verbs.hpp>
#include <motionlang/generate/judgement_report.hpp>

#include <doctest/doctest.h>
#include <set>

#include <motionlang/kinematics/motion_tools.hpp>

#include "../../support/check_error.hpp"
#include "../../support/synthetic_motion.hpp"
#include "../../support/temporary_folder.hpp"
#include "../../support/thread_processes.hpp"
#include "../../support/word_count_encoder.hpp"
#include "fake_models.hpp"

namespace ml = motionlang;

namespace {

std::string why(const ml::Motion& motion, const char* verb) {
  return ml::why_not_done(ml::find_verb(verb), ml::trace_motion(motion));
}

/// A figure that stands, changed in each frame by f(motion, frame, share of the time).
template <class F>
ml::Motion standing(int frames, F f) {
  const auto stand = synthetic::walk({.frames = 1});
  ml::Motion m = stand;
  for (int i = 1; i < frames; ++i) {
    m.root.push_back(stand.root[0]);
    m.local.insert(m.local.end(), stand.local.begin(), stand.local.end());
    f(m, i, static_cast<double>(i) / frames);
  }
  return m;
}
/// A figure that raises its right arm `times` times.
ml::Motion raising(int times, bool both = false) {
  return standing(60, [&](ml::Motion& m, int i, double t) {
    const double angle = 2.6 * std::abs(std::sin(3.14159 * (times - 0.5) * t));
    m.rotations(i)[17] = synthetic::about_z(angle) * m.rotations(i)[17];
    if (both) m.rotations(i)[16] = synthetic::about_z(-angle) * m.rotations(i)[16];
  });
}

}  // namespace

TEST_CASE("a walk does what the verb says, and no other") {
  const ml::Motion walk = synthetic::walk({.frames = 80});
  CHECK(why(walk, "walk") == "");
  for (const char* other : {"run", "walk backwards", "stand", "turn left", "turn right", "sit down", "raise both arms",
                            "jump forward", "bend forward", "wave", "kick", "lie down", "crawl"})
    CHECK_MESSAGE(why(walk, other) != "", other);
  CHECK(why(synthetic::walk({.frames = 60, .turn = 0.5}), "turn left") == "");
  CHECK(why(synthetic::walk({.frames = 60, .turn = -0.5}), "turn right") == "");
  CHECK(why(synthetic::walk({.frames = 60, .turn = 2.4}), "turn left").starts_with("turned 4"));
}

TEST_CASE("an arm that is raised was down before, comes up once, and alone") {
  CHECK(why(raising(1), "raise the right arm") == "");
  CHECK(why(raising(3), "raise the right arm").starts_with("starts again"));
  CHECK(why(raising(1, true), "raise the right arm").starts_with("other arm at"));
  CHECK(why(raising(1, true), "raise both arms") == "");
  CHECK(ml::find_verb("raise the right arm")
            .why_not(ml::trace_motion(ml::crop(raising(1), 45, 60)))
            .starts_with("arm starts"));
  CHECK(why(raising(1), "raise the left arm") != "");
}

TEST_CASE("jumps land, statues do not move, and what looks wrong is never done") {
  const auto jump = ml::resample(synthetic::jump(), 20);
  CHECK(why(jump, "jump") == "");
  CHECK(ml::find_verb("jump").why_not(ml::trace_motion(jump)) == "");
  CHECK(ml::find_verb("jump").why_not(ml::trace_motion(ml::crop(jump, 0, 15))) == "does not land");
  CHECK(ml::find_verb("jump forward").why_not(ml::trace_motion(jump)) == "ahead 0.00");
  const auto still = standing(40, [](ml::Motion&, int, double) {});
  CHECK(why(still, "stand") == "");
  CHECK(why(still, "dance").starts_with("stands like a statue"));
  ml::Motion high = synthetic::walk({.frames = 80});
  for (auto& p : high.root) p.y += 0.2;
  CHECK(why(high, "walk") == "hovers 4.00 s");
  CHECK(why(ml::crop(still, 0, 1), "stand") == "too short");
  CHECK_ERROR(ml::find_verb("fly"), "[motionlang.config.103] find_verb: 'fly' is not a judged verb");
}

TEST_CASE("prompts name verbs that exist, and become timelines") {
  CHECK(ml::own_prompts().size() == 12);
  CHECK(ml::newcomers_prompts(4).size() == 56);
  CHECK(ml::arm_prompts(4).size() == 30);
  CHECK(ml::trunk_prompts(4).size() == 19);
  CHECK(ml::paraphrase_prompts(4).size() >= 40);
  for (const auto& list : {ml::own_prompts(), ml::newcomers_prompts(4), ml::arm_prompts(4), ml::trunk_prompts(4),
                           ml::paraphrase_prompts(4)})
    for (const ml::JudgedPrompt& p : list) CHECK(p.rule() != "");
  const auto both = ml::arm_prompts(4).at(20);
  CHECK(both.name() == "walk forward + raise both arms");
  const auto timeline = both.timeline(20);
  CHECK(timeline.end() == 80);
  CHECK(timeline.intervals[1].start == 20);
  CHECK(timeline.intervals[1].parts.count() == 2);
}

TEST_CASE("a prompt of two texts is judged by both, the second where it lasts") {
  ml::JudgedPrompt prompt{{{"stand still", "stand"}, {"raise the right arm", "raise the right arm"}}, 3};
  prompt.texts[1].to = 0.999;
  CHECK(ml::verdict(prompt, raising(1)).why_not == "");
  prompt.texts[1].from = 0.6;
  CHECK(ml::verdict(prompt, raising(1)).why_not.starts_with("arm starts at"));
  const auto walked = ml::verdict(prompt, synthetic::walk({.frames = 60}));
  CHECK(walked.why_not.starts_with("speed"));
  CHECK(walked.speed > 0.5);
  CHECK_FALSE((walked.hovers || walked.sinks || walked.still));
}

TEST_CASE("captions that say a verb") {
  CHECK(ml::says(ml::find_verb("walk"), "walk forward"));
  CHECK_FALSE(ml::says(ml::find_verb("walk"), "walk forward and sit down"));
  CHECK(ml::says(ml::find_verb("punch"), "a person punches with the left hand"));
  CHECK_FALSE(ml::says(ml::find_verb("dance"), "dance"));  // nothing is listed
}

TEST_CASE("a model is judged by all prompts with several seeds") {
  const fake::Model model;
  const ml::Judgement j = ml::judge(model, ml::own_prompts(), {}, 3);
  CHECK(model.calls == 3);
  CHECK(j.motions() == 36);
  CHECK(j.made.empty());
  CHECK(j.verdicts.size() == 12);
  CHECK(j.verdicts[0].size() == 3);
  std::size_t done = 0;
  for (std::size_t i = 0; i < 12; ++i) done += j.done(i);
  CHECK(j.done() == done);
  CHECK((j.hovering() == 0 && j.sinking() == 0));
  CHECK(ml::judge(model, ml::own_prompts(), {}, 1, true).made.size() == 12);
  CHECK(ml::mean_distance(j, j) == 0);
  CHECK(ml::mean_distance(j, ml::Judgement{}, 36) == 0);
  ml::Judgement moved = j;
  for (auto& motion : moved.positions) {
    for (auto& p : motion) p.y += 0.25;
  }
  CHECK(std::abs(ml::mean_distance(j, moved) - 0.25) < 1e-12);
  CHECK_ERROR(ml::judge(model, ml::own_prompts(), {}, 0), "[motionlang.config.101] judge: 0 seeds");
}

namespace {

/// Walks whose speed depends on the seed and on the place.
class SeededWalks final : public ml::MotionModel {
 public:
  double fps() const override { return 20; }
  std::string system() const override { return "walks"; }

 private:
  std::vector<ml::Motion> make(std::span<const ml::Timeline> timelines, const ml::GenerateOptions& o) const override {
    std::vector<ml::Motion> out;
    for (std::size_t i = 0; i < timelines.size(); ++i)
      out.push_back(synthetic::walk({.frames = static_cast<int>(timelines[i].end()),
                                     .fps = 20,
                                     .steps_per_second = 0.2 * static_cast<double>(o.seed % 7 + i % 5)}));
    if (o.notes != nullptr) {  // positions in which the bones grow, faster with some seeds
      o.notes->layout = "smplrifke";
      for (std::size_t i = 0; i < timelines.size(); ++i) {
        std::vector<double>& features = o.notes->features.emplace_back();
        for (int frame = 0; frame < 3; ++frame) {
          for (int j = 0; j < 205; ++j)
            features.push_back(0.01 * j * (1 + 0.02 * frame * static_cast<double>(o.seed % 7)));
        }
      }
    }
    o.progress(1, 2), o.progress(2, 2);
    return out;
  }
};

}  // namespace

TEST_CASE("several processes judge as one does, and the first one counts the steps of all") {
  const SeededWalks model;
  const ml::Judgement alone = ml::judge(model, ml::own_prompts(), {.seed = 3}, 5, true);
  CHECK(alone.bones > 0);
  for (const ml::Index processes : {2, 3, 7}) {
    run_processes(processes, [&](const ThreadProcess& process) {
      std::vector<ml::Index> done;
      auto progress = [&](ml::Index d, ml::Index total) {
        CHECK(total == 5000);  // thousandths of seeds
        done.push_back(d);
        return true;
      };
      const ml::GenerateOptions options{.seed = 3, .progress = progress};
      const auto j = ml::judge(model, ml::own_prompts(), options, 5, true, ml::AnyCommunicator(process));
      CHECK(ml::describe_judgement(j, true) == ml::describe_judgement(alone, true));
      CHECK((j.skate == alone.skate && j.jitter == alone.jitter && j.bones == alone.bones));
      REQUIRE(j.positions.size() == alone.positions.size());
      for (std::size_t i = 0; i < j.positions.size(); ++i) {
        CHECK(j.positions[i] == alone.positions[i]);
        CHECK(j.made[i].local.size() == alone.made[i].local.size());
        CHECK(j.made[i].positions() == alone.made[i].positions());
        CHECK(j.made[i].skeleton == alone.made[i].skeleton);
      }
      if (process.rank() > 0) return;
      CHECK(std::is_sorted(done.begin(), done.end()));
      CHECK(done.back() == 5000);
    });
  }
}

TEST_CASE("processes share the seeds or the motions of a seed, never both") {
  const SeededWalks model;
  const std::string alone = ml::describe_judgement(ml::judge(model, ml::own_prompts(), {.seed = 3}, 5), true);
  run_processes(2, [&](const ThreadProcess& process) {
    const ml::AnyCommunicator all(process);
    const ml::GenerateOptions shared{.seed = 3, .communicator = all};
    CHECK(ml::describe_judgement(ml::judge(model, ml::own_prompts(), shared, 5, false, all), true) == alone);
  });
}

TEST_CASE("what fewer steps cost: a row for each number, compared with the first") {
  fake::Model model;
  model.diffusion_steps = 10;
  const std::vector<ml::Index> steps{10, 4};
  std::vector<ml::Index> seen;
  const auto rows = ml::steps_costs(model, ml::own_prompts(), {}, steps, 2,
                                    [&](const ml::StepsCost& row) { seen.push_back(row.steps); });
  CHECK(seen == steps);
  CHECK(model.calls == 4);
  const ml::Judgement j = ml::judge(model, ml::own_prompts(), {.steps = 4}, 2);
  CHECK(rows[1].done == static_cast<double>(j.done()) / 24);
  CHECK(rows[1].jitter == j.jitter);
  CHECK(rows[0].away == 0);
  CHECK(rows[0].seeds_apart == ml::mean_distance(j, j, 12));  // the fake model makes the same of each seed
  CHECK(rows[1].seeds_apart == 0);
  CHECK_ERROR(ml::steps_costs(model, ml::own_prompts(), {}, std::vector<ml::Index>{11}, 1), "11 steps");
}

TEST_CASE("the benches have names of their own, and prompts as long as asked") {
  std::set<std::string> names;
  for (const ml::JudgedBench& bench : ml::judged_benches()) {
    names.insert(bench.name);
    for (const ml::JudgedPrompt& p : bench.prompts(2)) CHECK(p.seconds == 2);
  }
  CHECK(names.size() == 5);
  CHECK(ml::judged_benches().front().name == "own");
  const auto own = ml::judged_benches().front().prompts(0);
  for (std::size_t i = 0; i < own.size(); ++i) CHECK(own[i].seconds == ml::own_prompts()[i].seconds);
}

TEST_CASE("warnings are compared with what failed, and a text is judged with what follows its action") {
  fake::Model model;
  ml::Judgement j;
  j.prompts = {{.texts = {{"sit", "sit"}}, .seconds = 8}, {.texts = {{"blorp", "walk"}}, .seconds = 4}};
  j.verdicts = {{{}, {}, {}, {.why_not = "stands"}}, {{.why_not = "stands"}, {.why_not = "stands"}, {}, {}}};
  CHECK(ml::warning_shares(model, j).failures == 0);  // it has no captions
  model.learned = counted::captions();
  const auto shares = ml::warning_shares(model, j);
  CHECK(shares.failures == 3);
  CHECK(shares.successes == 5);
  CHECK(shares.silent_failures == doctest::Approx(1.0 / 3));
  CHECK(shares.warned_successes == doctest::Approx(2.0 / 5));

  const ml::Judgement both[] = {j, j};
  const auto tried = ml::with_judged(model.learned, both);
  CHECK(*tried.success("sit") == 0.75);
  REQUIRE(tried.done().size() == 2);
  CHECK(tried.done()[0] == 0.5);  // of "blorp"
  ml::Judgement of_arm = j;
  of_arm.prompts[0].texts[0].parts = ml::BodyParts{}.with(ml::BodyPart::legs);
  CHECK(ml::with_judged(model.learned, std::span(&of_arm, 1)).done().size() == 1);

  const auto sit = j.prompts[0].timeline(model, {});
  REQUIRE(sit.intervals.size() == 2);
  CHECK(sit.intervals[1].text == "sit quietly");
  CHECK(sit.end() == 160);
  CHECK(j.prompts[0].timeline(model, {.cut_texts = false}).intervals.size() == 1);
  const ml::JudgedPrompt arms{.texts = {{"sit", "sit", ml::BodyParts{}.with(ml::BodyPart::legs)}}, .seconds = 8};
  CHECK(arms.timeline(model, {}) == arms.timeline(model.fps()));
}

TEST_CASE("prompts of a file: text, verb and seconds, and errors with the line") {
  const auto prompts = ml::parse_judged_prompts("take a seat # sit down # 5\n\na man jogs # jog\n", 4, "mine.txt");
  REQUIRE(prompts.size() == 2);
  CHECK(prompts[0].name() == "take a seat");
  CHECK(prompts[0].rule() == ml::find_verb("sit down").rule);
  CHECK(prompts[0].seconds == 5);
  CHECK(prompts[1].texts[0].verb == "jog");
  CHECK(prompts[1].seconds == 4);
  CHECK_ERROR(ml::parse_judged_prompts("walk # walk\nfly # fly", 4, "mine.txt"),
              "[motionlang.timeline.501] mine.txt:2:7: 'fly' is not one of the verbs: walk, ");
  CHECK_ERROR(ml::parse_judged_prompts("walk", 4, "mine.txt"), "mine.txt:1:5: expected 'text # verb # seconds'");
  CHECK_ERROR(ml::parse_judged_prompts("walk # walk # soon", 4, "mine.txt"), "'soon' is not a time in seconds");
  CHECK_ERROR(ml::parse_judged_prompts("\n", 4, "mine.txt"), "[motionlang.timeline.507] mine.txt: no line");
}

TEST_CASE("a judgement is a line for each prompt, the sum, and a row of a table") {
  ml::Judgement j;
  j.prompts = {ml::own_prompts().front()};
  j.verdicts = {{{}, {.why_not = "it turned", .hovers = true, .speed = 1.25}}};
  j.positions.resize(2);
  j.skate = 0.125, j.jitter = 3;
  const std::string text = ml::describe_judgement(j), details = ml::describe_judgement(j, true);
  CHECK(text.find("1/2      " + j.prompts[0].rule() + "\nall ") != std::string::npos);
  CHECK(
      text.ends_with(" 1/2 = 50 %\nfoot skate 0.125 m/s, jitter 3.0 m/s^3 (means over all motions)\n"
                     "hovering 50.0 %, sinking 0.0 %, statues 0.0 %\n"));
  CHECK(details.find("\n    seed 0: done (ahead 0.00 m/s, air 0.00 s, turned 0)\n"
                     "    seed 1: it turned (ahead 1.25 m/s, air 0.00 s, turned 0)\nall ") != std::string::npos);
  CHECK(ml::judgement_row(j, "own", 0) == "| own | own | 50 % | 50.0 / 0.0 / 0.0 % | 0.125 | 3 |\n");
  CHECK(ml::judgement_row(j, "arms", 4).starts_with("| arms | 4 s | 50 % |"));

  const ml::StepsCost cost{
      .steps = 20, .done = 0.75, .skate = 0.5, .jitter = 2, .bones = 0.01, .away = 0.02, .seconds = 3};
  const std::string row = ml::steps_cost_row("ddim", cost);
  CHECK(row == "| ddim | 20 | 75 % | 0.500 | 2.0 | 1.0 | 20 | 3.00 |\n");
  const auto columns = [](const std::string& lines) {
    return std::ranges::count(lines.substr(0, lines.find('\n')), '|');
  };
  CHECK(columns(ml::steps_cost_header()) == columns(row));
  CHECK(columns(ml::judgement_header()) == columns(ml::judgement_row(j, "own", 0)));
}

TEST_CASE("recordings are their measures, and the verbs that any of them says") {
  const ml::RecordedFigures figures{.segments = 3,
                                    .elsewhere = 1,
                                    .hovering = 0.25,
                                    .measures = {{"height", {1, 2, 3}}},
                                    .verbs = {{.name = "walk",
                                               .segments = 2,
                                               .done = 1,
                                               .why_not = {"clip: too slow"},
                                               .speed = {1, 1},
                                               .air = {0, 0},
                                               .turned = {5, 5}},
                                              {.name = "jump"}}};
  const std::string text = ml::describe_recordings(figures), details = ml::describe_recordings(figures, true);
  CHECK(text.starts_with("recordings: 3 segments on the floor, 1 elsewhere left out\nhovering 25.0 %, "));
  CHECK(text.find("\nheight                                  2.000") != std::string::npos);
  CHECK(text.find("\nwalk                       1/2     ") != std::string::npos);
  CHECK(text.find("jump") == std::string::npos);
  CHECK(text.find("too slow") == std::string::npos);
  CHECK(details.ends_with("\n    clip: too slow\n"));
}

TEST_CASE("a film strip of each motion is named by prompt and seed") {
  const TemporaryFolder folder;
  ml::Judgement j;
  j.prompts = {ml::own_prompts().front()};
  j.verdicts = {{{}, {.why_not = "it turned"}}};
  j.made = {synthetic::walk({.frames = 5}), synthetic::walk({.frames = 5, .turn = 1})};
  ml::write_judged_strips(folder / "strips", "own_0", j);
  const std::string first = ml::read_file(folder / "strips/own_0_0_0.png"),
                    second = ml::read_file(folder / "strips/own_0_0_1.png");
  CHECK(first.starts_with("\x89PNG"));
  CHECK(first != second);
}

TEST_CASE("the figures of recordings are in the metadata of weights") {
  CHECK(ml::recordings_line({{"real.skate", "0.1575"}, {"real.jitter", "90.26"}}, "weights") ==
        "recordings: foot skate 0.158 m/s, jitter 90.3 m/s^3\n");
  CHECK(ml::recordings_line({{"real.skate", "0.1575"}}, "weights").empty());
  CHECK_ERROR(ml::recordings_line({{"real.skate", "abc"}, {"real.jitter", "90"}}, "weights"),
              "[motionlang.config.107] weights: metadata 'real.skate' = 'abc' is not a number");
}
