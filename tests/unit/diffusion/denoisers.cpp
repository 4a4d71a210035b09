// Denoisers: dropout, texts, crops, what is refused. Laws are in tests/laws, numbers in the golden cases.
#include <motionlang/backend/eigen.hpp>

#include "../../support/check_error.hpp"
#include "../../support/small_modules.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using ml::Index;
using tensors::same_bits;
using B = ml::EigenBackend<float>;

namespace {

struct Input {
  ml::Sequences<B> x{tensors::normal<B, 2>({14, modules::small_features}, 1), ml::Offsets{7, 7}};
  std::vector<Index> t{3, 40};
  ml::TextFeatures<B> pooled = modules::PooledTexts::texts<B>(2, ml::Philox{.seed = 2});
  ml::TextFeatures<B> tokens = modules::TokenTexts::texts<B>(2, ml::Philox{.seed = 2});
};

template <class Small>
void check_dropout() {
  const Input in;
  const auto model = Small::template make<B>(ml::Philox{.seed = 1});
  const auto plain = model(in.x, in.t, in.pooled).rows;
  CHECK(same_bits(model(in.x, in.t, in.pooled).rows, plain));
  const auto with = [&](std::uint64_t seed) {
    return model(in.x, in.t, in.pooled, {.dropout = ml::Philox{.seed = seed}}).rows;
  };
  CHECK_FALSE(same_bits(with(1), plain));
  CHECK(same_bits(with(1), with(1)));
  CHECK_FALSE(same_bits(with(1), with(2)));
}

}  // namespace

TEST_CASE("dropout runs only when the context has a generator, and depends on nothing else") {
  check_dropout<modules::SmallMdmSmpl>();
  check_dropout<modules::SmallMdmEncoder>();
  check_dropout<modules::SmallMdmDecoder>();
}

TEST_CASE("the step and the text matter, and each only to its own sequence") {
  const Input in;
  const auto model = modules::SmallMdmSmpl::make<B>(ml::Philox{.seed = 1});
  const auto y = model(in.x, in.t, in.pooled);
  const auto later = model(in.x, std::vector<Index>{3, 41}, in.pooled);
  CHECK(same_bits(later[0], y[0]));
  CHECK_FALSE(same_bits(later[1], y[1]));
  const auto swapped = model(in.x, in.t, ml::gather(in.pooled, std::vector<Index>{0, 0}));
  CHECK(same_bits(swapped[0], y[0]));
  CHECK_FALSE(same_bits(swapped[1], y[1]));
}

TEST_CASE("what hosts have to know") {
  CHECK(modules::SmallMdmSmpl::make<B>({}).traits().crop_frames == 0);
  CHECK(modules::SmallMdmEncoder::make<B>({}).traits().empty_text_is_null);
  CHECK(modules::SmallMdmEncoder::make<B>({}).traits().crop_frames == 196);
  CHECK_FALSE(modules::SmallMdmEncoder::make<B>({}).traits().uses_lengths);
  const auto diffuse = modules::SmallMotionDiffuse<false>::make<B>({}).traits();
  CHECK(diffuse.prediction == ml::Prediction::eps);
  CHECK(diffuse.crop_frames == 64);
}

TEST_CASE("longer than the position table, a step that does not exist, lengths that differ in a gru: refused") {
  const Input in;
  const auto encoder = modules::SmallMdmEncoder::make<B>(ml::Philox{.seed = 1});  // 64 positions
  const ml::Sequences<B> long_one(ml::Tensor<B, 2>::zeros({64, modules::small_features}), ml::Offsets{64});
  const auto one = ml::gather(in.pooled, std::vector<Index>{0});
  CHECK_ERROR(encoder(long_one, std::vector<Index>{0}, one), "[motionlang.shape.203]");
  CHECK_ERROR(encoder(in.x, std::vector<Index>{0, 64}, in.pooled), "[motionlang.shape.203]");
  CHECK_ERROR(encoder(in.x, std::vector<Index>{0, -1}, in.pooled), "[motionlang.shape.203]");
  const ml::Sequences<B> narrow(ml::Tensor<B, 2>::zeros({14, 10}), in.x.offsets);
  CHECK_ERROR(encoder(narrow, in.t, in.pooled), "[motionlang.shape.201]");
  const auto gru = modules::SmallMdmGru::make<B>(ml::Philox{.seed = 1});
  const ml::Sequences<B> ragged(in.x.rows, ml::Offsets{6, 8});
  CHECK_ERROR(gru(ragged, in.t, in.pooled), "[motionlang.shape.207] MdmDenoiser: the gru");
  const auto diffuse = modules::SmallMotionDiffuse<false>::make<B>(ml::Philox{.seed = 1});
  CHECK_ERROR(diffuse(in.x, in.t, in.pooled), "[motionlang.shape.204] MotionDiffuseDenoiser: 2 texts, 0 end tokens");
  auto outside = in.tokens;
  outside.end_position = {0, outside.tokens.offsets.length(1)};
  CHECK_ERROR(diffuse(in.x, in.t, outside), "[motionlang.shape.203] MotionDiffuseDenoiser: end token at row 3 of 3");
  CHECK_ERROR(ml::gather(in.pooled, std::vector<Index>{2}), "[motionlang.shape.203] gather: text 2 of 2");
}

TEST_CASE("the released gru runs over the batch: there, a sequence depends on those before it") {
  const Input in;
  auto config = modules::small_mdm;
  config.arch = ml::MdmArch::gru;
  ml::Philox rng{.seed = 1};
  const ml::MdmDenoiser<B> released(config, rng);
  const auto both = released(in.x, in.t, in.pooled);
  const auto second =
      released({in.x[1], ml::Offsets{7}}, std::span(in.t).subspan(1), ml::gather(in.pooled, std::vector<Index>{1}));
  CHECK_FALSE(same_bits(second.rows, both[1]));
}
