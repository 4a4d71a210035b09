// generate_motion is the sum of its parts, and refuses options that contradict each other.
#include <doctest/doctest.h>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/compose/cut_texts.hpp>
#include <motionlang/generate/arm_overlay.hpp>
#include <motionlang/generate/samples.hpp>
#include <motionlang/generate/stmc_motion_model.hpp>
#include <motionlang/kinematics/floor_fix.hpp>
#include <motionlang/kinematics/smooth_motion.hpp>
#include <motionlang/systems/stmc.hpp>

#include "../support/check_error.hpp"
#include "../support/compositions.hpp"
#include "../support/small_denoisers.hpp"
#include "../support/small_model.hpp"
#include "../support/synthetic_motion.hpp"
#include "../support/thread_processes.hpp"

namespace ml = motionlang;
using ml::Timeline;
using B = ml::EigenBackend<float>;

namespace {

ml::Stmc<B> model() {
  auto m = small::model<B>();
  ml::prepare(m);
  return m;
}
ml::Motion finished(const ml::Motion& m) {
  return ml::lift_sunken_feet(ml::fix_feet(ml::stand_on_floor(ml::smooth_motion(m))));
}
bool same(const ml::Motion& a, const ml::Motion& b) { return a.local == b.local && a.root == b.root && a.fps == b.fps; }

}  // namespace

TEST_CASE("texts are cut, motions sampled, smoothed and put on their feet") {
  const auto stmc = model();
  const Timeline timeline = small::several_tracks();
  const ml::Philox rng{.seed = 3};
  const auto features = stmc.generate(ml::cut_texts(timeline, stmc.fps), rng, {.hidden = ml::HiddenTexts::ignore});
  const ml::Motion expected = finished(ml::stmc_motion(features, stmc.fps));
  CHECK(same(ml::generate_motion(stmc, timeline, {.seed = 3, .overlay_arms = false}), expected));
  const auto whole = stmc.generate(timeline, rng, {.guidance = 1.5, .steps = 4, .hidden = ml::HiddenTexts::ignore});
  CHECK(same(ml::generate_motion(stmc, timeline,
                                 {.seed = 3,
                                  .steps = 4,
                                  .guidance = 1.5,
                                  .cut_texts = false,
                                  .smooth = false,
                                  .fix_feet = false,
                                  .fix_floor = false,
                                  .overlay_arms = false}),
             ml::stmc_motion(whole, stmc.fps)));
  CHECK_FALSE(same(ml::generate_motion(stmc, timeline, {.seed = 4}), expected));

  // several timelines, samples, and the same model behind the interface of all models
  const std::vector<Timeline> two{timeline, small::one_track()};
  ml::GenerateNotes notes;
  const auto motions = ml::generate_motions(stmc, two, {.seed = 3, .overlay_arms = false, .notes = &notes});
  REQUIRE(motions.size() == 2);
  CHECK(same(motions[0], expected));
  CHECK(notes.layout == "smplrifke");
  CHECK(notes.features.size() == 2);
  const auto samples = ml::generate_samples(stmc, two, 2, {.seed = 3, .overlay_arms = false});
  for (const std::size_t t : {0u, 1u}) {
    CHECK(same(samples[t][0], motions[t]));
    CHECK_FALSE(same(samples[t][1], motions[t]));
  }
  const auto any = ml::stmc_motion_model(model(), {"walk"});
  CHECK(same(ml::generate_motion(*any, timeline, {.seed = 3, .overlay_arms = false}), expected));
  CHECK(any->steps() == 8);
  CHECK(any->takes_timelines());
  CHECK(any->words().knows("walk"));
  CHECK_FALSE(any->words().knows("run"));
  CHECK(any->captions().empty());
  CHECK(any->length_of("walk forward").pieces > 0);
  CHECK_ERROR(ml::generate_motion(*any, timeline, {.fact = 1}), "this is a diffusion model, which draws none");
}

TEST_CASE("modes: STMC's baselines, of which texts are not cut") {
  const auto stmc = model();
  const Timeline timeline = small::several_tracks();
  const ml::GenerateOptions raw{.seed = 3, .smooth = false, .fix_feet = false, .fix_floor = false};
  const auto made = [&](ml::StmcMode mode) {
    ml::GenerateOptions how = raw;
    how.mode = mode;
    return ml::generate_motion(stmc, timeline, how);
  };
  const ml::StmcOptions options{.hidden = ml::HiddenTexts::ignore};
  const auto expected = [&](compositions::Composition how, const Timeline& of) {
    const auto features = compositions::generate(how, stmc, std::span(&of, 1), ml::Philox{.seed = 3}, options);
    return ml::stmc_motion(features.front(), stmc.fps);
  };
  using Mode = ml::StmcMode;
  CHECK(same(made(Mode::sinc), expected(compositions::Composition::sinc, timeline)));
  CHECK(same(made(Mode::sinc_lerp), expected(compositions::Composition::sinc_lerp, timeline)));
  for (const ml::StmcMode mode : {Mode::single_track, Mode::one_text})
    CHECK(same(made(mode), expected(compositions::Composition::stmc, ml::timeline_of_mode(mode, timeline, stmc.fps))));
  CHECK_FALSE(same(made(Mode::sinc), made(Mode::sinc_lerp)));
  CHECK_FALSE(same(made(Mode::stmc), made(Mode::sinc_lerp)));
  for (const ml::GenerateOptions& o : {ml::GenerateOptions{.mode = Mode::sinc, .record = "r"},
                                       ml::GenerateOptions{.mode = Mode::one_text, .overlay_arms = true}})
    CHECK_THROWS_WITH_AS(ml::generate_motion(stmc, timeline, o),
                         doctest::Contains("excludes `keep`, `record`, `reuse` and"), ml::option_error);
}

TEST_CASE("the factor of the noise: what the model asks for, or what the caller does") {
  auto stmc = model();
  const Timeline timeline = small::one_track();
  const auto made = [&](std::optional<ml::NoiseScale> scale) {
    return ml::generate_motion(stmc, timeline, {.seed = 3, .noise_scale = scale});
  };
  const ml::Motion paper = made({}), published = made(ml::NoiseScale::posterior_variance);
  CHECK(same(made(ml::NoiseScale::posterior_std), paper));
  CHECK_FALSE(same(published, paper));
  stmc.sampling = ml::published_stmc_sampling;
  CHECK(same(made({}), published));
}

TEST_CASE("arms that the collage loses move as their texts make them alone") {
  const auto stmc = model();
  const Timeline timeline = small::several_tracks();
  const ml::GenerateOptions raw{.seed = 3, .smooth = false, .fix_feet = false, .fix_floor = false};
  ml::GenerateOptions without = raw;
  without.overlay_arms = false;
  ml::Motion expected = ml::generate_motion(stmc, timeline, without);
  std::vector<Timeline> alone;
  const auto texts = ml::arm_texts(timeline, 10);
  CHECK(texts.size() == 3);
  for (const ml::ArmText& t : texts) alone.push_back(t.alone);
  const auto arms = ml::generate_motions(stmc, alone, without);
  ml::Index laid = 0;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    if (!ml::is_arm_lost(expected, arms[i], texts[i])) continue;
    expected = ml::lay_arm_over(expected, arms[i], texts[i]), ++laid;
  }
  ml::Index calls = 0, most = 0;
  auto progress = [&](ml::Index done, ml::Index total) { return most = total, ++calls == done; };
  ml::GenerateOptions how = raw;
  how.overlay_arms = true, how.progress = progress;
  CHECK(same(ml::generate_motion(stmc, timeline, how), expected));
  CHECK((calls == 16 && most == 16));  // two runs of 8 steps
  CHECK(laid > 0);
}

TEST_CASE_TEMPLATE("any denoiser and text encoder", D, ml::MdmDenoiser<small::B>, ml::MotionDiffuseDenoiser<small::B>) {
  const auto stmc = small::model_of<D>();
  const Timeline text = small::one_text(20);
  const auto features = stmc.generate(text, ml::Philox{.seed = 3});
  const ml::Motion expected = finished(ml::stmc_motion(features, stmc.fps));
  CHECK(same(ml::generate_motion(stmc, text, {.seed = 3}), expected));
}

TEST_CASE("parts of a list, and several processes, make the motions of the whole list") {
  const auto stmc = model();
  std::vector<Timeline> timelines{small::several_tracks(), small::one_track(), small::several_tracks(),
                                  small::one_text(20), small::several_tracks()};
  const auto span = std::span<const Timeline>(timelines);
  const ml::KeptClip clip{.motion = synthetic::walk({.frames = 20}), .seconds = {{0, 0.5}}};
  std::vector<ml::GenerateOptions> all{{.seed = 3}, {.seed = 3, .overlay_arms = true}, {.seed = 3, .keep = clip}};
  for (const ml::StmcMode mode : {ml::StmcMode::sinc, ml::StmcMode::sinc_lerp, ml::StmcMode::single_track})
    all.push_back({.seed = 3, .mode = mode});
  for (std::size_t k = 0; k < all.size(); ++k) {
    CAPTURE(k);
    ml::GenerateNotes notes;
    all[k].notes = &notes;
    const auto whole = ml::generate_motions(stmc, span, all[k]);
    for (const std::size_t first : {1u, 3u, 4u}) {
      auto how = all[k];
      how.before = span.first(first), how.notes = nullptr;
      const auto part = ml::generate_motions(stmc, span.subspan(first), how);
      REQUIRE(part.size() == span.size() - first);
      for (std::size_t i = 0; i < part.size(); ++i) CHECK(same(part[i], whole[first + i]));
    }
    CHECK_FALSE(same(ml::generate_motion(stmc, span[2], {.seed = 3, .mode = all[k].mode}), whole[2]));
    for (const ml::Index processes : {2, 3, 7}) {
      run_processes(processes, [&](const ThreadProcess& process) {
        ml::GenerateNotes own;
        auto how = all[k];
        how.notes = &own, how.communicator = ml::AnyCommunicator(process);
        const auto made = ml::generate_motions(stmc, span, how);
        REQUIRE(made.size() == whole.size());
        for (std::size_t i = 0; i < made.size(); ++i) CHECK(same(made[i], whole[i]));
        CHECK((own.layout == notes.layout && own.features == notes.features && own.kept_moved == notes.kept_moved));
      });
    }
  }
}

namespace {

/// A model whose recurrent network goes over the motions of a batch, as published.
auto mixing_model() {
  auto stmc = small::model_of<ml::MdmDenoiser<small::B>>();
  ml::Philox rng{.seed = 4};
  stmc.denoiser = ml::MdmDenoiser<small::B>({.nfeats = 205,
                                             .arch = ml::MdmArch::gru,
                                             .text_dim = 12,
                                             .latent_dim = 32,
                                             .ff_size = 48,
                                             .num_layers = 2,
                                             .num_heads = 4,
                                             .gru_over_batch = true,
                                             .crop_frames = small::crop_frames},
                                            rng);
  return stmc;
}

/// As many tokens as a text has words. Texts of a batch are padded to the longest one.
struct WordTokens {
  ml::CaptionEncoder<small::B> captions;

  template <ml::Backend C>
  ml::TextFeatures<C> encode(std::span<const std::string> texts) const {
    std::vector<ml::Index> which, lengths;
    for (const std::string& text : texts) {
      lengths.push_back(1 + static_cast<ml::Index>(std::count(text.begin(), text.end(), ' ')));
      which.insert(which.end(), static_cast<std::size_t>(lengths.back()), static_cast<ml::Index>(lengths.size()) - 1);
    }
    return {{ml::gather(captions(texts), which), ml::Offsets(lengths)}};
  }
};

}  // namespace

TEST_CASE("a model whose motions depend on each other makes no part of a list") {
  auto stmc = small::model_of<ml::MdmDenoiser<small::B>>();
  const std::vector<Timeline> two{small::one_text(20), small::one_text(20)};
  const ml::GenerateOptions second{.seed = 3, .before = std::span<const Timeline>(two).first(1)};
  CHECK_NOTHROW(ml::generate_motion(stmc, two[1], second));
  stmc = mixing_model();
  CHECK_NOTHROW(ml::generate_motion(stmc, two[1], {.seed = 3}));
  CHECK_THROWS_WITH_AS(
      ml::generate_motion(stmc, two[1], second),
      doctest::Contains("[motionlang.config.102] a motion of this model depends on the other timelines"),
      ml::option_error);
}

TEST_CASE("every process refuses a list whose motions depend on each other, also one without a part") {
  const auto check = [&](const auto& stmc, const std::vector<Timeline>& list, bool refused,
                         const std::vector<Timeline>& before = {}) {
    const auto boxed = ml::stmc_motion_model(stmc);
    for (const ml::Index processes : {2, 3}) {
      CAPTURE(processes);
      run_processes(processes, [&](const ThreadProcess& process) {
        const ml::GenerateOptions shared{.seed = 3, .before = before, .communicator = ml::AnyCommunicator(process)};
        const auto generate = [&] { ml::generate_motions(stmc, list, shared); };
        const auto generate_boxed = [&] { ml::generate_motions(*boxed, list, shared); };
        if (!refused) {
          CHECK_NOTHROW(generate());
          CHECK_NOTHROW(generate_boxed());
          return;
        }
        const doctest::Contains why("[motionlang.config.102] a motion of this model depends on the other timelines");
        CHECK_THROWS_WITH_AS(generate(), why, ml::option_error);
        CHECK_THROWS_WITH_AS(generate_boxed(), why, ml::option_error);
      });
    }
  };
  const auto list = [](const std::vector<std::string>& texts) {
    std::vector<Timeline> out;
    for (const std::string& text : texts) out.push_back(ml::whole_body_timeline(text, 20));
    return out;
  };
  check(mixing_model(), list({"walk", "walk"}), true);
  check(mixing_model(), list({"walk"}), false);
  // The part of rank 0 has texts of one token, which another part makes longer.
  const auto plain = small::model_of<ml::MdmSmplDenoiser<small::B>>();
  const ml::Stmc<small::B, ml::MdmSmplDenoiser<small::B>, WordTokens> words{
      .denoiser = plain.denoiser,
      .text_encoder = {plain.text_encoder.captions},
      .motion_normalizer = plain.motion_normalizer,
      .text_normalizer = plain.text_normalizer,
      .diffusion = plain.diffusion};
  check(words, list({"walk", "walk", "turn left"}), true);
  check(words, list({"walk", "walk", "turn"}), false);
  check(plain, list({"walk", "walk", "turn left"}), false);
  check(words, list({"walk"}), true, list({"turn left"}));
}

TEST_CASE("processes with other lists end with one error, also if the model could not make one of them") {
  const auto stmc = mixing_model();
  run_processes(2, [&](const ThreadProcess& process) {
    const std::vector<Timeline> list(static_cast<std::size_t>(1 + process.rank()), small::one_text(20));
    CHECK_THROWS_WITH_AS(ml::generate_motions(stmc, list, {.communicator = ml::AnyCommunicator(process)}),
                         doctest::Contains("[motionlang.config.102] rank 1 of 2 has other timelines"),
                         ml::config_error);
  });
}

TEST_CASE("options that contradict each other, or that the model cannot do, are option errors") {
  const auto stmc = model();
  const Timeline timeline = small::one_track();
  const auto refused = [&](const ml::GenerateOptions& options, const char* message) {
    CHECK_THROWS_WITH_AS(ml::generate_motion(stmc, timeline, options), doctest::Contains(message), ml::option_error);
  };
  refused({.steps = 9}, "[motionlang.config.105] 9 steps are asked for, this model has 8");
  const ml::KeptClip walk{synthetic::walk({.frames = 20})};
  refused({.noise = "n", .keep = walk}, "[motionlang.config.102] keep excludes noise, record and reuse");
  refused({.record = "r", .keep = walk}, "[motionlang.config.102] keep excludes");
  refused({.reuse = "r", .keep = walk}, "[motionlang.config.102] keep excludes");
  refused({.noise = "n", .record = "r"}, "[motionlang.config.102] noise excludes record and reuse");
  refused({.keep_beyond = 1}, "[motionlang.config.102] keep_beyond needs reuse");
  ml::KeptClip late = walk;
  late.seconds = {{0.5, 1.5}};
  refused({.keep = late},
          "[motionlang.config.101] keep: 0.5-1.5 is frames 10:30 at 20 per second; the motion to keep "
          "has 20, the timeline 40");
  late.seconds = {{0.5, 0.51}};
  refused({.keep = late}, "0.5-0.51 is frames 10:10");
  refused({.noise = "n", .before = std::span(&timeline, 1)},
          "[motionlang.config.102] `noise` is a file of all timelines; with `before`, these are only a part of them");
  CHECK_ERROR(ml::generate_motion(stmc, timeline, {.noise = "nowhere"}), "[motionlang.io.401]");
  CHECK_ERROR(ml::generate_motion(stmc, timeline, {.reuse = "nowhere"}), "[motionlang.io.401]");
}
