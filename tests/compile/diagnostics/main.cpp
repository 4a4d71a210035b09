// SPDX-License-Identifier: MIT
// With MOTIONLANG_DIAGNOSTICS a message says in which module of the model it went wrong, from the outermost one.
#include <cstdio>
#include <string>

#include <motionlang/backend/reference.hpp>
#include <motionlang/nn/conv_stack.hpp>
#include <motionlang/nn/sequence_vae.hpp>
#include <motionlang/nn/transformer_decoder.hpp>
#include <motionlang/nn/transformer_encoder.hpp>

namespace ml = motionlang;
using B = ml::ReferenceBackend<float>;

namespace {

int failures = 0;

/// f must fail in the module `path`.
template <class F>
void fails_at(const std::string& path, const F& f) {
  std::string message = "nothing";
  try {
    f();
  } catch (const ml::error& e) {
    message = e.what();
  }
  if (message.ends_with("; at " + path)) return;
  std::printf("expected: at %s\ngot: %s\n", path.c_str(), message.c_str());
  ++failures;
}

/// A model of a user's, over the library's.
struct Model {
  ml::Linear<B> in;
  ml::TransformerEncoder<B> mix;
  static constexpr auto fields() { return ml::fields("in", &Model::in, "mix.1", &Model::mix); }

  ml::Sequences<B> operator()(const ml::Sequences<B>& x) const {
    const ml::ModuleScope scope(*this);
    return mix(in(x));
  }
};

}  // namespace

int main() {
  ml::Philox rng;
  const ml::TransformerConfig config{.d_model = 8, .heads = 2, .d_ff = 16, .layers = 4};
  const ml::Linear<B> narrow(3, 16, rng);
  const ml::Sequences<B> x(ml::Tensor<B, 2>::randn({5, 8}, rng), ml::Offsets{2, 3});

  ml::TransformerEncoder<B> encoder(config, rng);
  encoder.layers[3].linear1 = narrow;
  fails_at("layers.3.linear1", [&] { encoder(x); });
  fails_at("layers.3.linear1", [&] { ml::encode_tokens(encoder, x, 1, 0.0); });
  encoder.layers[0].self_attn.out_proj = narrow;
  fails_at("layers.0.self_attn.out_proj", [&] { encoder(x); });
  encoder.layers[0].self_attn.in_proj_weight = narrow.weight;
  fails_at("layers.0.self_attn", [&] { encoder(x); });

  ml::TransformerDecoder<B> decoder(config, rng);
  decoder.layers[1].multihead_attn.out_proj = narrow;
  fails_at("layers.1.multihead_attn.out_proj", [&] { decoder(x, x); });
  decoder.layers[0].norm3 = ml::LayerNorm<B>(9);
  fails_at("layers.0.norm3", [&] { decoder(x, x); });

  Model model{ml::Linear<B>(8, 8, rng), encoder};
  fails_at("mix.1.layers.0.self_attn", [&] { model(x); });
  fails_at("in", [&] { model({ml::Tensor<B, 2>::zeros({5, 7}), x.offsets}); });
  fails_at("layers.0.self_attn", [&] { model.mix(x); });  // the outermost module has no name

  ml::ConvStack<B> convolutions;
  convolutions.conv(8, 8, 3, {.padding = 1}, rng).residual(9, rng);
  fails_at("1.model.0", [&] { convolutions(x); });

  if (failures == 0) std::puts("all paths are right");
  return failures;
}
