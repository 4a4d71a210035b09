// Golden functions: TM2T's recurrent model from text to motion, and its training against the model from motion to text.
// A source for each backend registers them: together they would take long to compile.
#pragma once

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/optim/adamw.hpp>

#include "tm2t_models.hpp"

namespace golden::tm2t_gru {

template <ml::Backend B>
ml::Sequences<B> words(const Case& c) {
  const auto lengths = c.values<Index>("in/text_lengths");
  return ml::from_padded(tensor<B, 3>(c, "in/word_emb"), std::span<const Index>(lengths));
}

template <ml::Backend B>
void gru(Case& c) {
  using A = ml::Autodiff<B>;
  const auto m = ml::convert<A>(golden::seq2seq_gru<B>(c));
  const Index pad = c.config()["codebook"].template as<Index>() + 2;
  const auto text = words<A>(c);
  const auto read = m.text_encoder(text);
  golden::out(c, "word_features", ml::to_padded(read.equally_far()));
  golden::out(c, "sentence", read.ends());
  auto state = m.start(text);
  const auto& hidden = state.hidden;
  golden::out(c, "init_hidden",
              ml::reshape<3>(ml::concat(std::span<const ml::Tensor<A, 2>>(hidden), 1),
                             {text.count(), std::ssize(hidden), hidden.front().size(1)}));
  const auto inputs = golden::padded_ids(c, "in/motion_ids", 1);
  std::vector<Index> first;
  for (Index s = 0; s < inputs.count(); ++s) first.push_back(inputs[s].front());
  const auto attention = m.step(first, state).attention;
  golden::out(c, "attention_first", attention.weights);
  golden::out(c, "attended_first", attention.attended);

  // what is to be written, where it is not the padding
  const auto all = golden::padded_ids(c, "in/motion_ids").without_ends(1, 0);
  std::vector<Index> wanted, rows;
  for (std::size_t i = 0; i < all.ids.size(); ++i) {
    if (all.ids[i] != pad) wanted.push_back(all.ids[i]), rows.push_back(static_cast<Index>(i));
  }
  auto padded = [&](const ml::Tensor<A, 2>& logits) {
    return ml::reshape<3>(logits, {inputs.count(), inputs.offsets.length(0), -1});
  };
  const auto own = m.logits(text, inputs, false);
  golden::out(c, "logits_free", padded(own));
  golden::out(c, "loss_free", ml::sum(ml::cross_entropies(ml::gather(own, rows), wanted)));
  const auto forced = m.logits(text, inputs, true);
  golden::out(c, "logits", padded(forced));
  const auto loss = golden::out_summed_loss(c, ml::gather(forced, rows), wanted);
  const auto gradients = golden::out_gradients(c, m, loss);
  c.out_scalar("grad_norm", ml::gradient_norm<A>(m, gradients));
}

template <ml::Backend B>
void inverse_alignment(Case& c) {
  using A = ml::Autodiff<B>;
  const auto config = c.config();
  const auto m = ml::convert<A>(golden::seq2seq_gru<B>(c, "weights/t2m_model."));
  const auto back = ml::convert<A>(golden::seq2seq_transformer<B>(c, config["m2t"], "weights/m2t_transformer."));
  const ml::MotionVocabulary vocabulary{config["codebook"].template as<Index>()};
  const auto noise = tensor<A, 3>(c, "noise/gumbel");
  const auto sample =
      ml::gumbel_sample(m, words<A>(c),
                        {.begin = vocabulary.begin(),
                         .end = vocabulary.end(),
                         .max_steps = config["max_steps"].template as<Index>(),
                         .top_k = config["top_k"].template as<Index>(),
                         .tau = config["tau"].template as<double>()},
                        [&](Index t) {
                          return ml::reshape<2>(ml::slice(noise, 0, t, t + 1), {noise.size(1), noise.size(2)});
                        });
  golden::out(c, "one_hot", sample.one_hot);
  c.out("lengths", {std::ssize(sample.lengths), 1}, sample.lengths);

  const Index pad = config["m2t"]["text_words"].template as<Index>();
  const auto described = golden::ids(c, "in/word_ids", pad);
  const auto padded = golden::padded_ids(c, "in/word_ids", 1);
  auto logits = [&](const ml::Sequences<A>& rows) {
    return back.logits(described.without_ends(0, 1), back.encode_shares(rows));
  };
  golden::out(c, "text_logits",
              golden::padded_logits(back, padded, golden::visible_ids(padded, pad), back.encode_shares(sample.rows())));
  const auto wanted = described.without_ends(1, 0).ids;
  // the gradient of the rows themselves: the same loss from a variable with their numbers
  ml::GumbelSample<A> copy{ml::variable<A>(ml::value_of<A>(sample.one_hot)), sample.lengths};
  const auto grad = ml::backward(ml::sum(ml::cross_entropies(logits(copy.rows()), wanted)))[copy.one_hot];
  golden::out(c, "grad_one_hot", grad);
  const auto loss = golden::out_summed_loss(c, logits(sample.rows()), wanted);
  const auto gradients = golden::out_gradients(c, m, loss, "t2m_model.");
  c.out_scalar("grad_norm", ml::gradient_norm<A>(m, gradients));
}

template <ml::Backend B>
std::vector<Registration> over(const std::string& variant) {
  return {{"tm2t text2motion gru", variant, gru<B>}, {"tm2t inverse alignment", variant, inverse_alignment<B>}};
}

}  // namespace golden::tm2t_gru
