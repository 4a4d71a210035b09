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

TEST_CASE_TEMPLATE("frames with several texts of unequal lengths", B, ml::ReferenceBackend<double>, ml::EigenBackend<float>) {
  const auto model = SmallMdmSmpl::make<B>(ml::Philox{.seed = 1});
  const ml::Offsets lengths{5, 9, 13};
  ml::Philox rng{.seed = 2};
  const ml::Sequences<B> x(ml::Tensor<B, 2>::randn({lengths.rows(), small_features}, rng), lengths);
  const std::vector<Index> t{0, 7, 49};
  several_texts_law(model, x, t, TokenTexts::texts<B>(3, ml::Philox{.seed = 3}));
}
