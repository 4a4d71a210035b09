// Recurrent networks from both ends: backward is forward on the turned sequence; packing changes nothing.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/nn/bi_gru.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using ml::Index, ml::Offsets;
using B = ml::ReferenceBackend<double>;
using Matrix = ml::Tensor<B, 2>;
using tensors::distance, tensors::normal, tensors::same_bits;

namespace {

Matrix turned(const Matrix& x) {
  std::vector<Index> rows;
  for (Index r = x.size(0); r-- > 0;) rows.push_back(r);
  return ml::gather(x, rows);
}

}  // namespace

TEST_CASE("GruLayer backwards is forwards on the turned sequence") {
  ml::Philox rng{.seed = 1};
  const ml::GruLayer<B> gru(3, 4, rng);
  const ml::Sequences<B> x(normal<B, 2>({5, 3}, 2), Offsets{5});
  const auto h0 = normal<B, 2>({1, 4}, 3);
  const auto backwards = gru(x, h0, true);
  CHECK(same_bits(backwards.rows, turned(gru(x.with(turned(x.rows)), h0).rows)));
  CHECK_ERROR(gru(x, normal<B, 2>({2, 4}, 3)), "[motionlang.shape.204]");
}

TEST_CASE("BiGruEncoder: a sequence alone and among others, shorter and longer ones") {
  ml::Philox rng{.seed = 4};
  const ml::BiGruEncoder<B> encoder(3, 4, rng);
  const ml::Sequences<B> x(normal<B, 2>({10, 3}, 5), Offsets{2, 5, 3});
  const auto all = encoder(x);
  const auto far = all.equally_far();
  for (Index s = 0; s < 3; ++s) {
    const Index n = x.offsets.length(s);
    const auto one = encoder(ml::Sequences<B>(x[s], Offsets{n}));
    CHECK(distance(ml::slice(all.ends(), 0, s, s + 1), one.ends()) < 1e-14);
    CHECK(distance(far[s], one.equally_far().rows) < 1e-14);
    // the last row has both ends
    CHECK(same_bits(ml::slice(far[s], 0, n - 1, n), ml::slice(all.ends(), 0, s, s + 1)));
  }
  CHECK_ERROR(encoder(ml::Sequences<B>(x[0], Offsets{2, 0})).ends(), "[motionlang.shape.203]");
}
