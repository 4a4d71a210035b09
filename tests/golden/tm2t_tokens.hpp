// Golden functions: TM2T's motion tokenizer, its losses and its discriminator. A source for each backend registers
// them: together they would take long to compile.
#pragma once

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/features/normalizer.hpp>

#include "tm2t_models.hpp"

namespace golden::tm2t_tokens {

template <ml::Backend B>
ml::Sequences<B> batch(const Case& c, const std::string& name) {
  return ml::from_equal(tensor<B, 3>(c, name));
}
template <ml::Backend B>
void out_batch(Case& c, const std::string& name, const ml::Sequences<B>& x) {
  golden::out(c, name, ml::to_padded(x));
}

template <ml::Backend B>
void vq_encoder(Case& c) {
  ml::Philox rng;
  const auto channels = c.config()["channels"].as<std::vector<Index>>();
  ml::VqEncoder<B> m(c.config()["dim_pose"].as<Index>() - 4, channels, rng);
  ml::load_module(m, c.file(), "weights/");
  out_batch(c, "latent", m(batch<B>(c, "in/x")));
}

template <ml::Backend B>
void vq_decoder(Case& c) {
  ml::Philox rng;
  const auto channels = c.config()["channels"].as<std::vector<Index>>();
  ml::VqDecoder<B> m(c.config()["latent"].as<Index>(), channels, c.config()["n_resblk"].as<Index>(), rng);
  ml::load_module(m, c.file(), "weights/");
  out_batch(c, "motion", m(batch<B>(c, "in/z")));
}

template <ml::Backend B>
void quantiser(Case& c) {
  using A = ml::Autodiff<B>;
  ml::Philox rng;
  ml::VectorQuantizer<B> inner(c.config()["codebook"].template as<Index>(), c.config()["latent"].template as<Index>(),
                               c.config()["beta"].template as<double>(), rng);
  ml::load_module(inner, c.file(), "weights/");
  const auto m = ml::convert<A>(inner);
  const auto shape = c.shape("in/z");
  const auto z = ml::variable<A>(golden::rows<B>(c, "in/z"));
  const auto q = m(z);
  c.out("indices", q.codes);
  c.out("map2index", q.codes);
  golden::out(c, "loss_emb", q.loss);
  c.out_scalar("perplexity", q.perplexity);
  c.out("z_q", shape, q.straight_through.span());
  c.out("codebook_rows", shape, q.rows.span());
  const auto loss = q.loss + ml::sum(q.straight_through * golden::rows<A>(c, "in/upstream"));
  golden::out(c, "loss", loss);
  const auto grad_z = golden::out_gradients(c, m, loss)[z];
  c.out("grad_z", shape, grad_z.span());
}

template <ml::Backend B>
ml::VqDiscriminator<B> discriminator(const Case& c, Index hidden, Index layers, const std::string& prefix) {
  ml::Philox rng;
  ml::VqDiscriminator<B> m(c.config()["dim_pose"].as<Index>(), hidden, layers, rng);
  ml::load_module(m, c.file(), prefix);
  return m;
}
/// The discriminator of a case with the whole tokenizer.
template <ml::Backend B>
ml::VqDiscriminator<B> second_network(const Case& c) {
  return discriminator<B>(c, c.config()["disc_hidden"].as<Index>(), c.config()["disc_layers"].as<Index>(),
                          "weights/discriminator.");
}
/// Some records are wrong: their running statistics of before the forwards are those of after, from which nobody can
/// tell what comes after. README.md has the proof.
inline bool records_after_as_before(const Case& c, const std::string& path) {
  const std::string before = "weights/discriminator." + path, after = "out/after_" + path;
  return c.name().starts_with("tm2t/vq-disc-loss-gan-") && path.find(".running_") != std::string::npos &&
         c.has(before) && c.has(after) && std::ranges::equal(c.tensor(before).bytes, c.tensor(after).bytes);
}
template <class M>
void out_statistics(Case& c, const M& m) {
  ml::visit_tensors(m, [&](const std::string& path, const auto& t) {
    records_after_as_before(c, path) ? c.leave_out("after_" + path) : golden::out_if_wanted(c, "after_" + path, t);
  });
}

template <ml::Backend B>
void generator_loss(Case& c) {
  using A = ml::Autodiff<B>;
  const auto m = ml::convert<A>(golden::motion_tokenizer<B>(c));
  const auto x = batch<A>(c, "in/motions");
  const auto result = m(x);
  std::optional<ml::VqDiscriminator<A>> second;
  if (c.config()["use_gan"].template as<bool>()) second = ml::convert<A>(second_network<B>(c));
  const auto terms =
      ml::tokenizer_losses<A>(result, x, second ? &*second : nullptr, c.config()["lambda_adv"].template as<double>());
  for (const auto& term : terms.terms) golden::out(c, "loss_" + term.name, term.value);
  out_batch(c, "recon", result.reconstruction);
  c.out_scalar("perplexity", result.quantized.perplexity);
  const auto loss = terms.total();
  golden::out(c, "loss", loss);
  golden::out_gradients(c, m, loss);
}

template <ml::Backend B>
void discriminator_loss(Case& c) {
  using A = ml::Autodiff<B>;
  auto m = ml::convert<A>(second_network<B>(c));
  const auto x = batch<B>(c, "in/motions");
  const auto decoded = golden::motion_tokenizer<B>(c)(x).reconstruction;
  auto constant = [](const ml::Sequences<B>& s) {
    return ml::Sequences<A>(ml::Tensor<A, 2>::from(s.rows.to_vector(), s.rows.shape()), s.offsets);
  };
  const auto real = m.train(constant(x)), generated = m.train(constant(decoded));
  const auto loss =
      ml::hinge_discriminator_loss(real.logits, generated.logits) * c.config()["lambda_adv"].template as<double>();
  golden::out(c, "loss", loss);
  out_batch(c, "real_features", real.features);
  out_statistics(c, m);
  golden::out_gradients(c, m, loss, "discriminator.");
}

template <ml::Backend B>
void discriminator_alone(Case& c) {
  auto m = discriminator<B>(c, c.config()["hidden"].as<Index>(), c.config()["layers"].as<Index>(), "weights/");
  const auto x = batch<B>(c, "in/x");
  auto result = [&](const std::string& mode, const typename ml::VqDiscriminator<B>::Result& said) {
    out_batch(c, "features_" + mode, said.features);
    out_batch(c, "logits_" + mode, said.features.with(said.logits));
  };
  result("eval", std::as_const(m)(x));
  result("train", m.train(x));
  out_statistics(c, m);
}

template <ml::Backend B>
void tokenising(Case& c) {
  const auto m = golden::motion_tokenizer<B>(c);
  const ml::Normalizer<B> normalizer{tensor<B, 1>(c, "in/mean"), tensor<B, 1>(c, "in/std")};
  const auto motion = normalizer.normalize(tensor<B, 2>(c, "in/motion"));
  const Index unit = c.config()["unit_length"].as<Index>(), length = motion.size(0) / unit * unit;
  std::vector<Index> ids;
  const auto starts = c.values<Index>("noise/start");
  for (const Index start : starts) {
    const ml::Sequences<B> frames(ml::slice(motion, 0, start, start + length), ml::Offsets{length});
    const auto pass = m.tokens(frames).ids;
    ids.insert(ids.end(), pass.begin(), pass.end());
  }
  c.out("ids", {std::ssize(starts), length / unit}, ids);
}

template <ml::Backend B>
std::vector<Registration> over(const std::string& variant) {
  return {{"tm2t vq encoder", variant, vq_encoder<B>},
          {"tm2t vq decoder", variant, vq_decoder<B>},
          {"tm2t quantiser", variant, quantiser<B>},
          {"tm2t vq generator loss", variant, generator_loss<B>},
          {"tm2t discriminator loss", variant, discriminator_loss<B>},
          {"tm2t discriminator", variant, discriminator_alone<B>},
          {"tm2t tokenising", variant, tokenising<B>}};
}

}  // namespace golden::tm2t_tokens
