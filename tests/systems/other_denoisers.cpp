// STMC over each of the three published denoisers, where windows around cuts have no frames.
#include <doctest/doctest.h>

#include "../support/compositions.hpp"
#include "../support/small_denoisers.hpp"
#include "../support/threads.hpp"

namespace ml = motionlang;
using ml::BodyParts, ml::Index, ml::Timeline;
using small::B, small::crop_frames;

namespace {

constexpr ml::Philox noise_rng{.seed = 11};

}  // namespace

TEST_CASE_TEMPLATE("without overlap, neighbours know nothing of each other", D, ml::MdmSmplDenoiser<B>,
                   ml::MdmDenoiser<B>, ml::MotionDiffuseDenoiser<B>) {
  const auto model = small::model_of<D>();
  const Timeline timeline{{{"walk forward", 0, 9, BodyParts::all()},
                           {"sit down", 9, 20, BodyParts::all()},
                           {"wave the right hand", 20, 32, BodyParts::all()}}};
  const auto whole = model.generate(timeline, noise_rng, {.overlap = 0});
  CHECK(whole.shape() == ml::Shape{32, 205});
  CHECK(small::is_finite(whole));
  // Denoisers that hide frames behind a crop: every interval alone, on its own stretch of the noise, gives its frames.
  // MDM as published sees what follows a crop; that is nothing at the end of the timeline only.
  const bool sees_more = !model.denoiser.traits().uses_lengths;
  for (std::size_t i = sees_more ? 2 : 0; i < 3; ++i) {
    const auto& interval = timeline.intervals[i];
    const Timeline alone{{{interval.text, 0, interval.end - interval.start, BodyParts::all()}}};
    auto stretch = [&](Index draw, const ml::Shape& s) {
      return ml::slice(model.noise(noise_rng, draw, {1, interval.start + s[1], s[2]}), 1, interval.start,
                       interval.start + s[1]);
    };
    const auto motion = model.generate_from(std::span(&alone, 1), stretch, {.overlap = 0}).front();
    CHECK_MESSAGE(small::numbers(motion) == small::numbers(ml::slice(whole, 0, interval.start, interval.end)), i);
  }
}

TEST_CASE_TEMPLATE("however few rows go through the denoiser at once, the motion has the same bits", D,
                   ml::MdmSmplDenoiser<B>, ml::MdmDenoiser<B>, ml::MotionDiffuseDenoiser<B>) {
  auto model = small::model_of<D>();
  ml::prepare(model);
  const std::vector<Timeline> timelines{
      {{{"walk forward", 0, 14, BodyParts::all()}, {"sit down", 14, 28, BodyParts::all()}}}, small::one_text(12)};
  for (const auto how : compositions::all) {
    const auto all = compositions::generate(how, model, timelines, noise_rng, {.rows_at_once = 0});
    for (int threads : {1, 2}) {
      const Threads scope(threads);
      for (Index rows : {1, 30, 50, 1000}) {
        const auto some = compositions::generate(how, model, timelines, noise_rng, {.rows_at_once = rows});
        for (std::size_t m : {0u, 1u}) CHECK_MESSAGE(small::numbers(some[m]) == small::numbers(all[m]), rows, " rows");
      }
    }
  }
}

namespace {

/// MotionDiffuse that counts how often it encodes its texts.
struct Counting {
  ml::MotionDiffuseDenoiser<B> inner;
  std::shared_ptr<int> encodings = std::make_shared<int>(0);

  static constexpr auto fields() { return ml::fields("inner", &Counting::inner); }
  ml::DenoiserTraits traits() const { return inner.traits(); }
  auto encode(const ml::TextFeatures<B>& text) const {
    ++*encodings;
    return inner.encode(text);
  }
  template <class Text>
  ml::Sequences<B> operator()(const ml::Sequences<B>& x, std::span<const Index> t, const Text& text) const {
    if constexpr (std::same_as<Text, ml::TextFeatures<B>>)
      return inner(x, t, encode(text));
    else
      return inner(x, t, text);
  }
};

}  // namespace

TEST_CASE("texts are encoded once for all steps") {
  const auto model = small::model_of<ml::MotionDiffuseDenoiser<B>>();
  const ml::Stmc<B, Counting, small::Encoder> counting{.denoiser = {model.denoiser},
                                                       .text_encoder = model.text_encoder,
                                                       .motion_normalizer = model.motion_normalizer,
                                                       .text_normalizer = model.text_normalizer,
                                                       .diffusion = model.diffusion};
  const auto motion = counting.generate(small::one_text(12), noise_rng);
  CHECK(*counting.denoiser.encodings == 1);
  CHECK(small::numbers(motion) == small::numbers(model.generate(small::one_text(12), noise_rng)));
}

namespace {

/// Remembers which texts it was asked for.
struct Listening {
  ml::CaptionEncoder<B> inner;
  std::shared_ptr<std::vector<std::vector<std::string>>> calls =
      std::make_shared<std::vector<std::vector<std::string>>>();

  template <ml::Backend C>
  ml::TextFeatures<C> encode(std::span<const std::string> texts) const {
    calls->emplace_back(texts.begin(), texts.end());
    return inner.template encode<C>(texts);
  }
};

}  // namespace

TEST_CASE("every text goes through the text encoder once, however often the timelines say it") {
  const auto model = small::model<B>();
  const ml::Stmc<B, ml::MdmSmplDenoiser<B>, Listening> listening{.denoiser = model.denoiser,
                                                                 .text_encoder = {model.text_encoder},
                                                                 .motion_normalizer = model.motion_normalizer,
                                                                 .text_normalizer = model.text_normalizer,
                                                                 .diffusion = model.diffusion,
                                                                 .sampling = model.sampling};
  const std::vector<Timeline> timelines{{{{"walk forward", 0, 9, BodyParts::all()},
                                          {"sit down", 9, 20, BodyParts::all()},
                                          {"walk forward", 20, 32, BodyParts::all()}}},
                                        {{{"sit down", 5, 20, BodyParts::all()}}}};
  for (const auto how : compositions::all) {
    const auto motions = compositions::generate(how, listening, timelines, noise_rng);
    CHECK(*listening.text_encoder.calls == std::vector<std::vector<std::string>>{{"", "walk forward", "sit down"}});
    listening.text_encoder.calls->clear();
    const auto same = compositions::generate(how, model, timelines, noise_rng);
    for (std::size_t m : {0u, 1u}) CHECK(small::numbers(motions[m]) == small::numbers(same[m]));
  }
}

TEST_CASE_TEMPLATE("STMC, its baselines and every overlap give a motion, on intervals of a single frame too", D,
                   ml::MdmSmplDenoiser<B>, ml::MdmDenoiser<B>, ml::MotionDiffuseDenoiser<B>) {
  const auto model = small::model_of<D>();
  const Timeline tiny{{{"walk forward", 0, 1, BodyParts::all()},
                       {"sit down", 1, 2, BodyParts{}.with(ml::BodyPart::legs)},
                       {"raise both arms", 4, 9, BodyParts{}.with(ml::BodyPart::left_arm)}}};
  for (Index overlap : {0, 1, 5}) {
    for (const auto how : compositions::all) {
      const auto motion =
          compositions::generate(how, model, std::span(&tiny, 1), noise_rng, {.overlap = overlap}).front();
      CHECK(motion.shape() == ml::Shape{9, 205});
      CHECK(small::is_finite(motion));
    }
  }
}

TEST_CASE_TEMPLATE("crops that are too long are refused", D, ml::MdmDenoiser<B>, ml::MotionDiffuseDenoiser<B>) {
  const auto model = small::model_of<D>();
  CHECK(model.generate(small::one_text(crop_frames), noise_rng, {.steps = 1}).size(0) == crop_frames);
  CHECK_THROWS_WITH_AS(model.generate(small::one_text(crop_frames + 1), noise_rng),
                       doctest::Contains("[motionlang.timeline.508] timeline: 'wave the right hand' needs a crop of 25 "
                                         "frames with its overlap; the denoiser accepts 24"),
                       ml::timeline_error);
}

TEST_CASE("MDM's unconditional text is zero, whatever the encoder says about \"\"") {
  const auto timeline = small::one_text(20);
  auto motion_of = [&]<class D>(const ml::Stmc<B, D, small::Encoder>& model) {
    return small::numbers(model.generate(timeline, noise_rng));
  };
  CHECK(motion_of(small::model_of<ml::MdmDenoiser<B>>(1)) == motion_of(small::model_of<ml::MdmDenoiser<B>>(0)));
  CHECK(motion_of(small::model_of<ml::MotionDiffuseDenoiser<B>>(1)) !=
        motion_of(small::model_of<ml::MotionDiffuseDenoiser<B>>(0)));
}
