// TM2T's tokenizer: published sizes, four frames for a token, contacts are not read, what the adversarial losses move.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/loss/adversarial.hpp>
#include <motionlang/vae/motion_tokenizer.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using ml::Index, ml::Offsets;
using B = ml::ReferenceBackend<double>;
using tensors::distance, tensors::normal, tensors::same_bits;

namespace {

ml::MotionTokenizer<B> small_tokenizer() {
  ml::Philox rng{.seed = 1};
  return ml::MotionTokenizer<B>({.features = 9, .channels = {6, 5}, .codes = 7, .residual_blocks = 1}, rng);
}

}  // namespace

TEST_CASE("the published tokenizer has the published numbers of parameters") {
  ml::NoInit none;
  const ml::MotionTokenizer<ml::EigenBackend<float>> m({}, none);
  CHECK(ml::parameter_count(m.vq_encoder) == 17'844'224);
  CHECK(ml::parameter_count(m.vq_decoder) == 23'043'233);
  CHECK(ml::parameter_count(m.quantizer) == 1'048'576);
  CHECK(m.vocabulary().size() == 1027);
}

TEST_CASE("four frames are one token, one token is four frames; each motion by itself") {
  const auto m = small_tokenizer();
  const ml::Sequences<B> x(normal<B, 2>({24, 9}, 2), Offsets{8, 16});
  const auto tokens = m.tokens(x);
  CHECK(tokens.offsets == Offsets{2, 4});
  const auto back = m.motions(tokens);
  CHECK(back.offsets == x.offsets);
  CHECK(distance(back.rows, m(x).reconstruction.rows) < 1e-12);
  const auto alone = m.tokens(ml::Sequences<B>(x[1], Offsets{16}));
  CHECK(std::equal(alone.ids.begin(), alone.ids.end(), tokens[1].begin(), tokens[1].end()));
  auto changed = x.rows.to_vector();
  for (std::size_t r = 0; r < 24; ++r) changed[9 * r + 5] += 3;  // a contact
  CHECK(m.tokens(x.with(ml::Tensor<B, 2>::from(changed, {24, 9}))).ids == tokens.ids);
  CHECK_ERROR(m.motions(ml::IdSequences::one(std::array<Index, 1>{7})),
              "[motionlang.shape.203]");  // a mark is not a code
  ml::Philox rng;
  CHECK_ERROR(ml::MotionTokenizer<B>({.channels = {}}, rng), "[motionlang.config.101]");
}

TEST_CASE("a latent of another width gets a convolution of its own") {
  ml::Philox rng;
  const std::vector<Index> channels{6, 4};
  const ml::VqDecoder<B> m(5, channels, 1, rng);
  std::vector<std::string> names;
  ml::visit_tensors(m, [&](const std::string& path, const auto&) { names.push_back(path); });
  CHECK(names == std::vector<std::string>{"main.0.weight", "main.0.bias", "main.1.model.0.weight",
                                          "main.1.model.0.bias", "main.1.model.2.weight", "main.1.model.2.bias",
                                          "main.3.weight", "main.3.bias", "main.5.weight", "main.5.bias"});
  CHECK(m(ml::Sequences<B>(normal<B, 2>({3, 5}, 1), Offsets{3})).rows.shape() == ml::Shape{6, 4});
}

TEST_CASE("the generator is judged by a discriminator in training; in use its judgement is repeatable") {
  using A = ml::Autodiff<B>;
  const auto m = ml::convert<A>(small_tokenizer());
  ml::Philox rng{.seed = 5};
  const ml::VqDiscriminator<B> fresh(9, 4, 2, rng);
  auto d = ml::convert<A>(fresh);
  const ml::Sequences<A> x(normal<A, 2>({16, 9}, 6), Offsets{16});
  const auto with = ml::tokenizer_losses<A>(m(x), x, &d);
  CHECK(with.terms.size() == 3);
  CHECK(with.total().item() ==
        doctest::Approx(with.terms[0].value.item() + with.terms[1].value.item() + 0.5 * with.terms[2].value.item()));
  CHECK(ml::tokenizer_losses<A>(m(x), x).terms.size() == 2);
  double counted = 0;
  ml::visit_tensors(d, [&](const std::string& path, const auto& t) {
    if (path.ends_with("tracked")) counted += t.span()[0];
  });
  CHECK(counted == 2);  // both norms have seen one batch
  const ml::Sequences<B> y(normal<B, 2>({16, 9}, 6), Offsets{16});
  CHECK(same_bits(fresh(y).logits, fresh(y).logits));
  CHECK(fresh(y).features.width() == 2);
}

TEST_CASE("hinge losses: what is judged right by more than the margin costs nothing") {
  const auto real = ml::Tensor<B, 2>::from({2, 0.5}, {2, 1}), generated = ml::Tensor<B, 2>::from({-3, 1}, {2, 1});
  CHECK(ml::hinge_discriminator_loss(real, generated).item() == doctest::Approx((0.25 + 1) / 2));
  CHECK(ml::hinge_generator_loss(generated).item() == doctest::Approx(1));
}
