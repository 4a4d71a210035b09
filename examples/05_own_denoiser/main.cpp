// A denoiser of your own: a model is a struct that lists its fields, and it runs on every backend.
#include <cstdio>
#include <span>
#include <vector>

#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>
#include <motionlang/diffusion/denoiser.hpp>
#include <motionlang/nn/positional_encoding.hpp>
#include <motionlang/nn/timestep_embedding.hpp>
#include <motionlang/nn/transformer_encoder.hpp>

namespace ml = motionlang;

template <ml::Backend B>
struct TinyDenoiser {
  ml::Linear<B> in, out, text;
  ml::TimestepEmbedding<B> time;
  ml::TransformerEncoder<B> mix;
  ml::PositionTable<B> positions;

  static constexpr auto fields() {
    using M = TinyDenoiser;
    return ml::fields("in", &M::in, "out", &M::out, "text", &M::text, "time", &M::time, "mix", &M::mix, "positions",
                      &M::positions);
  }
  TinyDenoiser() = default;
  TinyDenoiser(ml::Index features, ml::Index width, ml::Rng auto& rng)
      : in(features, width, rng),
        out(width, features, rng),
        text(16, width, rng),
        time(width, rng),
        mix({.d_model = width, .heads = 4, .d_ff = 2 * width, .layers = 2}, rng),
        positions(200, width) {}

  /// Sequences are packed: x.rows holds the frames of all sequences, and there is no padding to mask.
  ml::Sequences<B> operator()(const ml::Sequences<B>& x, std::span<const ml::Index> t,
                              const ml::TextFeatures<B>& c) const {
    const ml::Sequences<B> step(time(positions.rows(), t), ml::Offsets::equal(x.count(), 1));
    const auto prefix = concat_tokens(step, text(c.tokens));
    return last_rows(out(mix(add_positions(concat_tokens(prefix, in(x)), positions.rows()))), x.offsets);
  }
  ml::DenoiserTraits traits() const { return {}; }
};
static_assert(ml::Denoiser<TinyDenoiser<ml::XtensorBackend<double>>, ml::XtensorBackend<double>>);

template <ml::Backend To, ml::Backend B>
double first_number(const TinyDenoiser<B>& model, const std::vector<double>& frames, const std::vector<double>& words) {
  const auto as = [](const std::vector<double>& v) { return std::vector<typename To::scalar>(v.begin(), v.end()); };
  const auto other = ml::convert<To>(model);
  const ml::Sequences<To> x(ml::Tensor<To, 2>::from(as(frames), {5, 3}),
                            ml::Offsets{2, 3});  // two sequences, 2 and 3 frames
  const auto c = ml::TextFeatures<To>::pooled(ml::Tensor<To, 2>::from(as(words), {2, 16}));
  const std::vector<ml::Index> t{10, 90};
  return static_cast<double>(other(x, t, c).rows.at(0, 0));
}

int main() {
  using B = ml::ReferenceBackend<double>;
  ml::Philox rng{.seed = 1};
  const TinyDenoiser<B> model(3, 32, rng);
  std::vector<double> frames(15), words(32);
  rng.normal(std::span<double>(frames));
  rng.normal(std::span<double>(words));
  std::printf("%td parameters\n", ml::parameter_count(model));
  std::printf("reference, double %.4f\n", first_number<B>(model, frames, words));
  std::printf("xtensor, float    %.4f\n", first_number<ml::XtensorBackend<float>>(model, frames, words));
}
