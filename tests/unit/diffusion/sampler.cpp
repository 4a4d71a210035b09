// Predictions, guidance and samplers, with networks whose answer is known.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/diffusion/guidance.hpp>
#include <motionlang/diffusion/sampler.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using ml::Index, ml::Prediction;
using B = ml::EigenBackend<double>;
using Matrix = ml::Tensor<B, 2>;
using tensors::distance, tensors::same_bits;

namespace {

const ml::GaussianDiffusion process(ml::CosineSchedule{.steps = 20});

Matrix noise(Index draw) { return tensors::normal<B, 2>({3, 4}, static_cast<std::uint64_t>(draw) + 100); }
Matrix no_noise(Index) { throw std::logic_error("noise was asked for"); }
const Matrix start = noise(-1), goal = noise(-2);

/// A network that knows the answer, and one that depends on what it sees.
Matrix knows(const Matrix&, Index) { return goal; }
Matrix looks(const Matrix& x, Index t) { return ml::tanh(x) * (1.0 / (1.0 + static_cast<double>(t))); }

}  // namespace

TEST_CASE("every prediction says the same about x0, and conversions go there and back") {
  for (Index t : {0, 7, 18}) {
    const std::span<const Index> at(&t, 1);
    const auto eps = noise(1), x = ml::q_sample(process, goal, at, eps);
    const auto score = ml::convert_prediction(process, Prediction::eps, Prediction::score, eps, x, at);
    CHECK(distance(ml::eps_from_x0(process, goal, x, at), eps) < 1e-9);
    CHECK(distance(ml::score_from_x0(process, goal, x, at), score) < 1e-9);
    const auto mean = ml::posterior_mean(process, goal, x, at);
    CHECK(distance(ml::posterior_mean_from_eps(process, eps, x, at), mean) < 1e-9);
    CHECK(distance(ml::posterior_mean_from_score(process, score, x, at), mean) < 1e-9);
    for (const auto& [from, value] : {std::pair{Prediction::x0, goal},
                                      {Prediction::eps, eps},
                                      {Prediction::score, score},
                                      {Prediction::x_prev, mean}}) {
      CHECK(distance(ml::to_x0(process, from, value, x, at), goal) < 1e-9);
      CHECK(distance(ml::convert_prediction(process, from, Prediction::eps, value, x, at), eps) < 1e-9);
      CHECK(distance(ml::convert_prediction(process, from, Prediction::score, value, x, at), score) < 1e-9);
    }
    CHECK_ERROR(ml::convert_prediction(process, Prediction::x0, Prediction::x_prev, goal, x, at),
                "[motionlang.config.102]");
  }
}

TEST_CASE("guidance: weight 1 is the conditional answer, 0 the unconditional one") {
  CHECK(distance(ml::guide(start, goal, 1.0), start) < 1e-15);
  CHECK(same_bits(ml::guide(start, goal, 0.0), goal));
  CHECK(distance(ml::guide(start, goal, 2.5), start * 2.5 - goal * 1.5) < 1e-14);
  const auto weights = Matrix::from({1, 0, 3}, {3, 1});
  const auto each = ml::guide(start, goal, weights);
  CHECK(distance(ml::slice(each, 0, 0, 1), ml::slice(start, 0, 0, 1)) < 1e-15);
  CHECK(same_bits(ml::slice(each, 0, 1, 2), ml::slice(goal, 0, 1, 2)));
}

TEST_CASE("a network that knows the answer gives it, whatever the sampler") {
  CHECK(distance(ml::sample_ancestral(process, start, knows, noise), goal) < 1e-12);
  CHECK(distance(ml::sample_ddim(process, start, knows, no_noise, 0), goal) < 1e-12);
  CHECK(distance(ml::sample_ddim(process, start, knows, noise, 1), goal) < 1e-12);
  for (int order : {2, 3, 4}) CHECK(distance(ml::sample_plms(process, start, knows, order), goal) < 1e-9);
  for (int order : {2, 3, 4}) {  // who watches sees what comes out
    auto last = start;
    const auto watch = [&](Index, const auto& step) { last = step.x_prev; };
    const auto made = ml::sample_plms(process, start, looks, order, {}, {}, watch);
    CHECK(distance(made, last) == 0);
  }
  CHECK_ERROR(ml::sample_plms(process, start, knows, 1), "[motionlang.config.101]");
  CHECK_ERROR(ml::sample_plms(process, start, knows, 5), "[motionlang.config.101]");
}

TEST_CASE("the options choose the sampler; names are read and written") {
  using Sampler = ml::SamplingOptions::Sampler;
  Index drawn = 0;
  const auto draws = [&](Index draw) {
    ++drawn;
    return draw == 0 ? start : noise(draw - 1);
  };
  CHECK(same_bits(ml::sample<B, 2>(process, looks, draws, {}), ml::sample_ancestral(process, start, looks, noise)));
  CHECK(drawn == process.steps() + 1);
  drawn = 0;
  CHECK(same_bits(ml::sample<B, 2>(process, looks, draws, {.sampler = Sampler::plms, .order = 3}),
                  ml::sample_plms(process, start, looks, 3)));
  CHECK(drawn == 1);
  CHECK(same_bits(ml::sample<B, 2>(process, looks, draws, {.sampler = Sampler::ddim, .eta = 0.5}),
                  ml::sample_ddim(process, start, looks, noise, 0.5)));
  for (const char* name : {"ddpm", "ddim", "plms"}) CHECK(ml::to_string(ml::parse_sampler(name)) == name);
  CHECK_ERROR(ml::parse_sampler("euler"), "[motionlang.config.103] sampler 'euler' is not one of ddpm, ddim, plms");
}

TEST_CASE("DDIM without eta is deterministic and asks for no noise; with eta 1 it is ancestral") {
  const auto x = ml::sample_ddim(process, start, looks, no_noise, 0);
  CHECK(same_bits(ml::sample_ddim(process, start, looks, no_noise, 0), x));
  const auto stochastic = ml::sample_ddim(process, start, looks, noise, 1);
  CHECK_FALSE(same_bits(stochastic, x));
  CHECK(distance(ml::sample_ancestral(process, start, looks, noise), stochastic) < 1e-9);
  for (double eta : {-0.1, 1.1, std::nan("")})
    CHECK_ERROR(ml::sample_ddim(process, start, looks, noise, eta), "[motionlang.config.101] ddim_step: eta = ");
}

TEST_CASE("DDIM inverted brings a sample back to its noise") {
  const auto same = [](const Matrix& x, Index) { return x; };  // predicts x0 = x: the fixed point of both directions
  const ml::GaussianDiffusion fine(ml::LinearSchedule{.steps = 1000, .scale_betas = 0.1});
  auto x = ml::sample_ddim(fine, start, same, no_noise, 0);
  for (Index t = 0; t + 1 < fine.steps(); ++t) x = ml::ddim_inversion_step(fine, x, same(x, t), t);
  CHECK(distance(x, start) < 0.02);
}

TEST_CASE("the published noise rule gives another motion with the same ends") {
  const ml::StepOptions published{.noise_scale = ml::NoiseScale::posterior_variance};
  const auto a = ml::sample_ancestral(process, start, looks, noise),
             b = ml::sample_ancestral(process, start, looks, noise, published);
  CHECK_FALSE(same_bits(a, b));
  CHECK(distance(ml::sample_ancestral(process, start, knows, noise, published), goal) < 1e-12);
}

TEST_CASE("options of a whole run have the noise of the thesis; the published one has a name") {
  CHECK(ml::SamplingOptions{}.noise_scale == ml::NoiseScale::posterior_std);
  CHECK(ml::published_stmc_sampling.noise_scale == ml::NoiseScale::posterior_variance);
  CHECK(ml::published_stmc_sampling.sampler == ml::SamplingOptions{}.sampler);
  CHECK(ml::parse_noise_scale("paper") == ml::NoiseScale::posterior_std);
  CHECK(ml::parse_noise_scale("published") == ml::NoiseScale::posterior_variance);
  CHECK_THROWS_WITH_AS(ml::parse_noise_scale("", "f:"), doctest::Contains("103] f: '' is neither paper nor published"),
                       ml::config_error);
}

TEST_CASE("clean estimates can be clipped and replaced") {
  const auto large = [](const Matrix&, Index) { return goal * 100.0; };
  const auto x = ml::sample_ancestral(process, start, large, noise, {.clip = true});
  for (double v : x.span()) CHECK(std::abs(v) == 1);
  const auto fix = [](Matrix, Index) { return start; };
  CHECK(distance(ml::sample_ancestral(process, start, looks, noise, {}, fix), start) < 1e-12);
  // a network that predicts x_{t-1} has the last word
  const ml::StepOptions previous{.prediction = ml::Prediction::x_prev, .clip = true};
  CHECK(distance(ml::sample_ancestral(process, start, large, noise, previous), goal * 100.0) < 1e-12);
}

TEST_CASE("a DDIM run begins at any index") {
  std::vector<Index> seen;
  const auto watch = [&](Index t, const auto&) { seen.push_back(t); };
  ml::sample_ddim(process, start, looks, no_noise, 0, {}, ml::detail::KeepX0{}, {}, watch, 4);
  CHECK(seen == std::vector<Index>{4, 3, 2, 1, 0});
}

TEST_CASE("progress counts every step, and can stop the work") {
  std::vector<Index> seen;
  const auto count = [&](Index done, Index total) {
    CHECK(total == 20);
    seen.push_back(done);
    return true;
  };
  const auto expected = [] {
    std::vector<Index> all;
    for (Index i = 1; i <= 20; ++i) all.push_back(i);
    return all;
  }();
  ml::sample_ancestral(process, start, looks, noise, {}, ml::detail::KeepX0{}, count);
  CHECK(std::exchange(seen, {}) == expected);
  ml::sample_ddim(process, start, looks, no_noise, 0, {}, ml::detail::KeepX0{}, count);
  CHECK(std::exchange(seen, {}) == expected);
  ml::sample_plms(process, start, looks, 2, {}, count);
  CHECK(seen == expected);

  int calls = 0;
  const auto network = [&](const Matrix& x, Index t) { return ++calls, looks(x, t); };
  const auto stop = [](Index done, Index) { return done < 5; };
  CHECK_THROWS_AS(ml::sample_ancestral(process, start, network, noise, {}, ml::detail::KeepX0{}, stop), ml::cancelled);
  CHECK(calls == 5);
}

TEST_CASE("sampling can start late, and steps can be watched") {
  std::vector<Index> watched;
  const auto watch = [&](Index t, const auto& step) {
    CHECK(step.x0.shape() == start.shape());
    watched.push_back(t);
  };
  ml::sample_ancestral(process, start, looks, noise, {}, ml::detail::KeepX0{}, {}, 3, watch);
  CHECK(watched == std::vector<Index>{3, 2, 1, 0});
}
