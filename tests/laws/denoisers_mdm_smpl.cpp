// MDM-SMPL.
#include "denoiser_laws.hpp"

namespace ml = motionlang;
using namespace laws;
using namespace modules;

TEST_CASE_TEMPLATE("laws of denoisers: MDM-SMPL", B, ml::ReferenceBackend<double>, ml::EigenBackend<float>,
                   ml::XtensorBackend<float>) {
  denoiser_laws<SmallMdmSmpl, B>();
}

TEST_CASE("laws of modules and of the tape: MDM-SMPL") {
  module_laws<SmallMdmSmpl>();
  tape_law<SmallMdmSmpl, ml::EigenBackend<double>>();
}

TEST_CASE_TEMPLATE("frames with several texts of unequal lengths", B, ml::ReferenceBackend<double>,
                   ml::EigenBackend<float>) {
  const auto model = SmallMdmSmpl::make<B>(ml::Philox{.seed = 1});
  const ml::Offsets lengths{5, 9, 13};
  ml::Philox rng{.seed = 2};
  const ml::Sequences<B> x(ml::Tensor<B, 2>::randn({lengths.rows(), small_features}, rng), lengths);
  const std::vector<Index> t{0, 7, 49};
  several_texts_law(model, x, t, TokenTexts::texts<B>(3, ml::Philox{.seed = 3}));
}

TEST_CASE_TEMPLATE("a text that is padded is one beside a longer text", B, ml::ReferenceBackend<double>,
                   ml::EigenBackend<float>) {
  const auto model = SmallMdmSmpl::make<B>(ml::Philox{.seed = 1});
  ml::Philox rng{.seed = 2};
  const ml::Sequences<B> x(ml::Tensor<B, 2>::randn({12, small_features}, rng), ml::Offsets{5, 7});
  const std::vector<Index> t{7, 49}, first{0};
  const auto texts = TokenTexts::texts<B>(2, ml::Philox{.seed = 3});
  const Index longest = texts.tokens.offsets.longest();
  const Index shorter = texts.tokens.offsets.length(0) < longest ? 0 : 1;
  REQUIRE(texts.tokens.offsets.length(shorter) < longest);
  const std::vector<Index> which{shorter}, step{t[static_cast<std::size_t>(shorter)]};
  auto one = gather(texts, std::span<const Index>(which));
  const ml::Sequences<B> frames(x[shorter], ml::Offsets{x.offsets.length(shorter)});
  const auto together = model(x, t, texts)[shorter];
  CHECK(tensors::distance(model(frames, step, one).rows, together) > 1e-3);
  one.padded_tokens = longest;
  CHECK(tensors::distance(model(frames, step, one).rows, together) < 1e-5);
  CHECK(tensors::distance(model(frames, ml::Offsets{1}, step, model.encode(one)).rows, together) < 1e-5);
  CHECK(gather(one, std::span<const Index>(first)).padded_tokens == longest);
}
