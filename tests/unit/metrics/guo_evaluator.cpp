// Guo's evaluator: published sizes, the zeros behind a motion, the order of rows, what is trained; the loss of shifted
// pairs.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/loss/margin.hpp>
#include <motionlang/metrics/guo_evaluator.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using ml::Index, ml::Offsets;
using B = ml::ReferenceBackend<double>;
using Matrix = ml::Tensor<B, 2>;
using tensors::distance, tensors::normal, tensors::same_bits;

namespace {

constexpr ml::GuoEvaluatorConfig small{.features = 9,
                                       .movement_hidden = 4,
                                       .movement_latent = 5,
                                       .word = 6,
                                       .pos = 3,
                                       .text_hidden = 4,
                                       .motion_hidden = 5,
                                       .embedding = 7};
template <ml::Backend C>
ml::GuoEvaluator<C> small_evaluator() {
  ml::Philox rng{.seed = 3};
  return ml::GuoEvaluator<C>(small, rng);
}

}  // namespace

TEST_CASE("the published sizes have the published numbers of parameters") {
  ml::NoInit none;
  const ml::GuoEvaluator<ml::EigenBackend<float>> m({}, none);
  CHECK(ml::parameter_count(m.text_encoder) == 4'100'288);
  CHECK(ml::parameter_count(m.motion_encoder) == 15'747'584);
}

TEST_CASE("motions keep their order and are judged alone as among others; contacts are not read") {
  const auto m = small_evaluator<B>();
  const ml::Sequences<B> x(normal<B, 2>({26, 9}, 4), Offsets{8, 13, 5});
  const auto all = m.embed_motions(x);
  for (Index s = 0; s < 3; ++s) {
    const ml::Sequences<B> one(x[s], Offsets{x.offsets.length(s)});
    CHECK(distance(ml::slice(all, 0, s, s + 1), m.embed_motions(one)) < 1e-13);
  }
  auto changed = x.rows.to_vector();
  for (std::size_t r = 0; r < 26; ++r) changed[9 * r + 8] += 1;
  CHECK(same_bits(m.embed_motions(x.with(Matrix::from(changed, {26, 9}))), all));
  CHECK_ERROR(m.embed_motions(ml::Sequences<B>(Matrix::zeros({3, 9}), Offsets{3})), "[motionlang.shape.203]");
  CHECK_ERROR(m.embed_motions(ml::Sequences<B>(Matrix::zeros({200, 9}), Offsets{200})), "[motionlang.shape.205]");
  CHECK_ERROR(m.embed_texts(ml::Sequences<B>(Matrix::zeros({3, 8}), Offsets{3})), "[motionlang.shape.204]");
}

TEST_CASE("two zero frames behind a motion suffice, none do not") {
  const auto m = small_evaluator<B>();
  const ml::Sequences<B> x(normal<B, 2>({12, 9}, 5), Offsets{12});
  const auto published = m.movements(x).rows;
  CHECK(distance(m.movements(x, 16).rows, published) < 1e-13);
  CHECK(distance(m.movements(x, 14).rows, published) < 1e-13);
  CHECK(distance(m.movements(x, 12).rows, published) > 1e-4);
}

TEST_CASE("gradients of a motion's embedding stop before the convolutions") {
  using A = ml::Autodiff<B>;
  const auto m = ml::convert<A>(small_evaluator<B>());
  const ml::Sequences<A> x(normal<A, 2>({8, 9}, 6), Offsets{8});
  const auto gradients = ml::backward(ml::sum(m.embed_motions(x)));
  CHECK(gradients.find(m.movement_encoder.out_net.weight.data()) == nullptr);
  CHECK(gradients.find(m.motion_encoder.encoder.hidden.data()) != nullptr);
}

TEST_CASE("shifted_margin_loss: the right partners, and the ones that many places on") {
  const auto x = Matrix::from({0, 0, 3, 4, 20, 0}, {3, 2}), y = Matrix::from({0, 1, 3, 4, 20, 2}, {3, 2});
  const auto terms = ml::shifted_margin_loss(x, y, 1).terms;
  CHECK(terms[0].value.item() == doctest::Approx((1 + 0 + 4) / 3.0).epsilon(1e-5));
  // distances to the next: 5, sqrt(17^2 + 2^2) and sqrt(20^2 + 1): only the first is short of 10
  CHECK(terms[1].value.item() == doctest::Approx(25 / 3.0).epsilon(1e-5));
  const auto same = ml::shifted_margin_loss(x, y, 3).terms;  // right partners, as the published draw allows
  CHECK(same[1].value.item() == doctest::Approx((81 + 100 + 64) / 3.0).epsilon(1e-5));
  CHECK_ERROR(ml::shifted_margin_loss(x, Matrix::zeros({3, 1}), 1), "[motionlang.shape.204]");
  CHECK_ERROR(ml::shifted_margin_loss(x, y, -1), "[motionlang.config.101]");
}
