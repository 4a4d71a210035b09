// STMC around a motion that is there: what is kept stays, the rest is of the texts and fits to it.
#include <doctest/doctest.h>

#include <limits>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/systems/stmc_keep.hpp>

#include "../support/check_error.hpp"
#include "../support/small_denoisers.hpp"

namespace ml = motionlang;
using ml::BodyPart, ml::BodyParts, ml::Index, ml::Timeline;
using small::B;

namespace {

constexpr ml::Philox rng{.seed = 7};

Timeline two_texts() {
  return {{{"walk", 0, 12, BodyParts::all()}, {"wave", 8, 20, BodyParts{}.with(BodyPart::right_arm)}}};
}

/// It has another seed, so that it differs from the motions that are made.
template <class Model>
ml::Tensor<B, 2> some_motion(const Model& model) {
  return model.generate(two_texts(), ml::Philox{.seed = 99});
}
double largest(const ml::Tensor<B, 2>& a, const ml::Tensor<B, 2>& b, Index frame, std::span<const Index> numbers) {
  double out = 0;
  for (const Index i : numbers) {
    const auto at = static_cast<std::size_t>(frame * a.size(1) + i);
    out = std::max(out, std::abs(static_cast<double>(a.span()[at]) - static_cast<double>(b.span()[at])));
  }
  return out;
}

}  // namespace

TEST_CASE_TEMPLATE("kept frames and parts come back, the others are made", D, ml::MdmSmplDenoiser<B>,
                   ml::MdmDenoiser<B>, ml::MotionDiffuseDenoiser<B>) {
  const auto model = small::model_of<D>();
  const std::vector<Timeline> timelines{two_texts(), two_texts()};
  const ml::Tensor<B, 2> clip = some_motion(model), free = model.generate(timelines, rng)[0];
  std::vector<Index> legs = model.layout.indices(BodyPart::legs), all, others;
  for (Index i = 0; i < model.layout.size; ++i) {
    all.push_back(i);
    if (std::find(legs.begin(), legs.end(), i) == legs.end()) others.push_back(i);
  }
  std::vector<ml::KeptMotion<B>> kept(2);
  kept[0] = {clip, {{{0, 5}}, {{16, 20}}, {{9, 12}, BodyParts{}.with(BodyPart::legs)}}};
  for (auto sampler : {ml::SamplingOptions::Sampler::ddpm, ml::SamplingOptions::Sampler::ddim}) {
    const ml::StmcOptions options{.steps = 4, .sampling = ml::SamplingOptions{.sampler = sampler}};
    const auto made = ml::generate_around<B>(model, timelines, rng, options, kept);
    REQUIRE(made.size() == 2);
    CHECK(small::is_finite(made[0]));
    for (Index f = 0; f < 20; ++f) {
      CAPTURE(f);
      const bool whole = f < 5 || f >= 16, only_legs = f >= 9 && f < 12;
      if (whole) CHECK(largest(made[0], clip, f, all) < 1e-5);
      if (only_legs) CHECK(largest(made[0], clip, f, legs) < 1e-5);
      if (only_legs) CHECK(largest(made[0], clip, f, others) > 1e-3);
      if (!whole && !only_legs) CHECK(largest(made[0], clip, f, legs) > 1e-3);
    }
    // the other timeline keeps nothing: the motion of a plain run
    CHECK(small::numbers(made[1]) == small::numbers(model.generate(timelines, rng, options)[1]));
    // what is made between is not what a run without the clip makes: it was made to fit
    CHECK(largest(made[0], model.generate(timelines, rng, options)[0], 7, all) > 1e-4);
  }
}

TEST_CASE("what cannot be kept is refused") {
  const auto model = small::model_of<ml::MdmSmplDenoiser<B>>();
  const std::vector<Timeline> timelines{two_texts()};
  ml::KeptMotion<B> kept{some_motion(model), {{{0, 5}}}};
  const auto around = [&] {
    return ml::generate_around<B>(model, timelines, rng, {}, std::span<const ml::KeptMotion<B>>(&kept, 1));
  };
  CHECK_NOTHROW(around());
  CHECK_ERROR(ml::generate_around<B>(model, timelines, rng, {}, {}),
              "[motionlang.config.102] generate_around: 0 motions to keep for 1");
  for (const ml::IndexRange& frames : {ml::IndexRange{0, 21}, {-1, 3}, {5, 5}}) {
    kept.parts = {{frames}};
    const std::string said = "[motionlang.config.101] generate_around: frames " + std::to_string(frames.begin);
    CHECK_ERROR(around(), said.c_str());
  }
  kept.parts = {{{0, 5}}};
  const auto good = kept.features;
  kept.features = ml::slice(good, 1, 0, 3);
  CHECK_ERROR(around(), "[motionlang.shape.205] generate_around: features (20, 3)");
  auto values = small::numbers(good);
  values[static_cast<std::size_t>(2 * model.layout.size + 1)] = std::numeric_limits<float>::quiet_NaN();
  kept.features = ml::Tensor<B, 2>::from(values, good.shape());
  CHECK_ERROR(around(), "[motionlang.numeric.301] generate_around: number 1 of frame 2 that is kept is nan");
}
