// TM2T as a whole, with small random models: motions to tokens to texts, texts to tokens to motions, the step of
// inverse alignment.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/systems/tm2t.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using ml::Index, ml::Offsets;
using B = ml::ReferenceBackend<double>;
using tensors::distance, tensors::normal;

namespace {

ml::GloVe small_words() {
  return ml::GloVe({"sos", "eos", "unk", "walk", "turn", "left"},
                   {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 0, 0, 1, 1}, 3);
}
template <ml::Backend C>
ml::Tm2t<C> small_tm2t() {
  ml::Philox rng{.seed = 7};
  return ml::Tm2t<C>({.tokenizer = {.features = 8, .channels = {5, 4}, .codes = 6, .residual_blocks = 1},
                      .motion_to_text = {.source_symbols = 9,
                                         .target_symbols = 7,
                                         .d_model = 8,
                                         .d_inner = 8,
                                         .heads = 2,
                                         .head_width = 4,
                                         .encoder_layers = 1,
                                         .decoder_layers = 1},
                      .text_to_motion = {.word = 3, .text_hidden = 4, .motion_hidden = 6, .symbols = 9}},
                     rng);
}

}  // namespace

TEST_CASE("motions are described in words without marks, alone as among others") {
  const auto m = small_tm2t<B>();
  const auto glove = small_words();
  const ml::Sequences<B> x(normal<B, 2>({22, 8}, 1), Offsets{8, 14});
  CHECK(m.tokens(x).offsets == Offsets{2, 3});  // the last two frames are not a token
  CHECK(m.marked(m.tokens(x)).offsets == Offsets{4, 5});
  const auto texts = m.describe(x, glove, {.max_length = 8});
  REQUIRE(texts.size() == 2);
  CHECK(m.describe(ml::Sequences<B>(x[1], Offsets{14}), glove, {.max_length = 8})[0] == texts[1]);
  const auto drawn = m.describe_at_random(x, glove, {.seed = 3}, {.max_steps = 6});
  CHECK(drawn == m.describe_at_random(x, glove, {.seed = 3}, {.max_steps = 6}));
  for (const auto& text : drawn) {
    for (const auto& word : glove.caption_tokens(text)) CHECK(glove.contains(word.word));
    CHECK(text.find("sos") == text.npos);
    CHECK(text.find("pad") == text.npos);
  }
  CHECK_ERROR(m.tokens(ml::Sequences<B>(normal<B, 2>({1, 8}, 1), Offsets{1})), "[motionlang.shape.205]");
}

TEST_CASE("texts become motions of four frames for each token, the same for the same seed; statistics are undone") {
  auto m = small_tm2t<B>();
  const std::vector<std::string> texts{"walk/VERB left/ADV", "turn/VERB"};
  const auto text = small_words().encode<B>(texts);
  const auto codes = m.write_tokens(text, {.seed = 2}, {.max_tokens = 7});
  REQUIRE(codes.count() == 2);
  for (const Index id : codes.ids) CHECK(id < 6);
  const auto motions = m.generate(text, {.seed = 2}, {.max_tokens = 7});
  for (Index i = 0; i < 2; ++i) CHECK(motions.offsets.length(i) == 4 * codes.offsets.length(i));
  CHECK(distance(m.motions(codes).rows, motions.rows) == 0);
  m.statistics.mean = ml::Tensor<B, 1>::full({8}, 5);
  m.statistics.std = ml::Tensor<B, 1>::full({8}, 2);
  CHECK(distance(m.motions(codes).rows, motions.rows * 2.0 + 5.0) < 1e-12);
  const auto empty = m.motions(ml::IdSequences::from({{}, {3}, {}}));
  CHECK(empty.offsets == Offsets{0, 4, 0});
  CHECK(m.motions(ml::IdSequences::from({{}})).rows.size(0) == 0);
}

TEST_CASE("inverse alignment reaches the model of texts to motions only through what it writes") {
  using A = ml::Autodiff<B>;
  const auto m = ml::convert<A>(small_tm2t<B>());
  const std::vector<std::string> texts{"walk/VERB left/ADV", "turn/VERB"};
  const auto words = m.word_vectors(small_words().encode<A>(texts));
  CHECK(words.width() == 3);
  ml::Philox rng{.seed = 4};
  const auto loss = ml::inverse_alignment_loss(m.t2m_model, m.m2t_transformer, words,
                                               ml::IdSequences::from({{0, 3, 5, 1}, {0, 4, 1}}),
                                               {.begin = 6, .end = 7, .max_steps = 5}, rng);
  CHECK(loss.item() > 0);
  const auto gradients = ml::backward(loss);
  CHECK(gradients.find(m.t2m_model.motion_decoder_step.att_layer.W_q.weight.data()) != nullptr);
  CHECK(gradients.find(m.tokenizer.quantizer.embedding.weight.data()) == nullptr);
}

TEST_CASE("the published sizes are those of the published models") {
  ml::NoInit none;
  const ml::Tm2t<ml::EigenBackend<float>> m({}, none);
  CHECK(m.m2t_transformer.encoder.src_word_emb->weight.shape() == ml::Shape{1027, 512});
  CHECK(m.m2t_transformer.decoder.symbols->weight.shape() == ml::Shape{4200, 512});
  CHECK(m.m2t_transformer.decoder.layer_stack.size() == 4);
  CHECK(m.vocabulary().pad() == 1026);
}
