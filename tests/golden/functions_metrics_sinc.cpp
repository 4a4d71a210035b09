// Golden functions: SINC's TEMOS score.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>
#include <motionlang/features/smplvelp.hpp>
#include <motionlang/metrics/temos_score.hpp>
#include <motionlang/vae/temos_encoder.hpp>

#include "geometry.hpp"
#include "tensors.hpp"

namespace {

using golden::Case, golden::Registration;
using golden::view;
namespace ml = motionlang;
using ml::Index;

template <ml::Backend B>
void temos_score(Case& c) {
  using S = typename B::scalar;
  const auto config = c.config();
  ml::Philox rng;
  ml::TemosMotionEncoder<B> encoder(config["nfeats"].template as<Index>(), true,
                                    {.d_model = config["latent_dim"].template as<Index>(),
                                     .heads = config["num_heads"].template as<Index>(),
                                     .d_ff = config["ff_size"].template as<Index>(),
                                     .layers = config["num_layers"].template as<Index>(),
                                     .activation = ml::Activation::gelu},
                                    golden::position_rows, rng);
  ml::load_module(encoder, c.file(), "weights/motionencoder.");
  const ml::Normalizer<B> statistics{golden::tensor<B, 1>(c, "in/mean"), golden::tensor<B, 1>(c, "in/std"),
                                     config["eps"].template as<double>()};
  std::array<std::vector<S>, 2> means;  // of reference and generated
  for (Index i = 0; c.has("in/reference_rots_" + std::to_string(i)); ++i) {
    for (const std::string side : {"reference", "generated"}) {
      const std::string number = std::to_string(i);
      const auto rotations = golden::matrices<S>(c, side + "_rots_" + number);
      const auto trans = golden::vectors<S>(c, side + "_trans_" + number);
      const auto features = ml::smplvelp_features(view(rotations), view(trans));
      const auto rows = ml::Tensor<B, 2>::from(features, {std::ssize(trans), std::ssize(features) / std::ssize(trans)});
      const auto mu = encoder({statistics.normalize(rows), ml::Offsets({std::ssize(trans)})}).mu;
      c.out("mu_" + side + "_" + number, {mu.size(1)}, mu.span());
      auto& all = means[side == "reference" ? 0 : 1];
      all.insert(all.end(), mu.span().begin(), mu.span().end());
    }
  }
  const Index width = config["latent_dim"].template as<Index>();
  const ml::Rows reference(means[0], width), generated(means[1], width);
  c.out("distance", ml::temos_distances(generated, reference));
  c.out_scalar("score", ml::temos_score(generated, reference));
}

const Registration score64{"sinc temos score", "reference<double>", temos_score<ml::ReferenceBackend<double>>};
const Registration score32{"sinc temos score", "eigen<float>", temos_score<ml::EigenBackend<float>>};
const Registration score_xtensor{"sinc temos score", "xtensor<float>", temos_score<ml::XtensorBackend<float>>};

}  // namespace
