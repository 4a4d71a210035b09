// The models from sequence to sequence: sequences alone and packed, causality, shared projections and their gradients,
// files with copies, the published sizes.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/loss/cross_entropy.hpp>
#include <motionlang/nn/seq2seq_gru.hpp>
#include <motionlang/nn/seq2seq_writer.hpp>
#include <motionlang/weights/module_file.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using ml::Index, ml::Offsets, ml::IdSequences;
using B = ml::ReferenceBackend<double>;
using A = ml::Autodiff<B>;
using tensors::distance, tensors::normal;
using Matrix = ml::Tensor<B, 2>;

namespace {

ml::Seq2SeqConfig small_config() {
  return {.source_symbols = 9,
          .target_symbols = 7,
          .d_model = 8,
          .d_inner = 12,
          .heads = 2,
          .head_width = 3,
          .encoder_layers = 2,
          .decoder_layers = 2,
          .source_positions = 10,
          .target_positions = 6};
}
ml::Seq2SeqTransformer<B> small_transformer(const ml::Seq2SeqConfig& config = small_config()) {
  ml::Philox rng{.seed = 1};
  return ml::Seq2SeqTransformer<B>(config, rng);
}
ml::Seq2SeqGru<B> small_gru(bool late = false, Index layers = 1) {
  ml::Philox rng{.seed = 2};
  return ml::Seq2SeqGru<B>(
      {.word = 4, .text_hidden = 3, .motion_hidden = 5, .layers = layers, .symbols = 8, .late = late}, rng);
}
const auto source = IdSequences::from({{1, 2, 3}, {4, 5, 6, 7, 8}}),
           target = IdSequences::from({{0, 5, 6, 1}, {0, 4, 1}});

}  // namespace

TEST_CASE("transformer: a pair alone and among others; no row knows what comes after it") {
  const auto m = small_transformer();
  const auto inputs = target.without_ends(0, 1);
  const auto all = m.logits(inputs, m.encode(source));
  Index row = 0;
  for (Index s = 0; s < 2; ++s) {
    const auto one = m.logits(IdSequences::one(inputs[s]), m.encode(IdSequences::one(source[s])));
    const Index n = inputs.offsets.length(s);
    CHECK(distance(ml::slice(all, 0, row, row + n), one) < 1e-13);
    CHECK(distance(ml::slice(all, 0, row, row + 1),
                   m.next_logits(IdSequences::one(inputs[s].first(1)), m.encode(IdSequences::one(source[s])))) < 1e-13);
    row += n;
  }
  CHECK_ERROR(m.encode(IdSequences::one(std::vector<Index>(11, 1))), "[motionlang.shape.203]");  // no such position
  CHECK_ERROR(m.encode(ml::Sequences<B>(normal<B, 2>({3, 8}, 1), Offsets{3})), "[motionlang.config.101]");
}

TEST_CASE("transformer: a one-hot source is its symbols; vectors go where vectors are read") {
  const auto m = small_transformer();
  const ml::Sequences<B> shares(ml::one_hot<B>(source.ids, 9), source.offsets);
  CHECK(distance(m.encode_shares(shares).rows, m.encode(source).rows) < 1e-13);
  auto config = small_config();
  config.source_symbols = 0, config.source_width = 4, config.target_width = 4, config.shared_projection = false;
  const auto v = small_transformer(config);
  const ml::Sequences<B> vectors(normal<B, 2>({5, 4}, 3), Offsets{2, 3});
  CHECK(v.logits(vectors, v.encode(vectors)).shape() == ml::Shape{5, 7});
  CHECK_ERROR(v.encode(source), "[motionlang.config.101]");
  CHECK_ERROR(v.encode_shares(shares), "[motionlang.config.101]");
  CHECK_ERROR(v.embed_target(target), "[motionlang.config.101]");
  config.shared_projection = true;
  ml::Philox rng;
  CHECK_ERROR(ml::Seq2SeqTransformer<B>(config, rng), "[motionlang.config.101]");
}

TEST_CASE("transformer: values of another width than queries and keys") {
  for (const Index width : {Index{2}, Index{6}}) {
    auto config = small_config();
    config.value_width = width;
    const auto m = small_transformer(config);
    const auto& layer = m.encoder.layer_stack[0].slf_attn;
    CHECK(layer.w_vs.weight.shape() == ml::Shape{config.heads * width, config.d_model});
    CHECK(layer.fc.weight.shape() == ml::Shape{config.d_model, config.heads * width});
    const ml::Sequences<B> x(normal<B, 2>({5, config.d_model}, 3), Offsets{2, 3});
    const auto heard = layer(x, x, true);
    // By definition: a softmax of q k^T / sqrt(head_width) for each head, row by row.
    const auto q = layer.w_qs(x.rows), k = layer.w_ks(x.rows), v = layer.w_vs(x.rows);
    std::vector<double> out;
    for (Index s = 0; s < 2; ++s) {
      for (Index i = x.offsets.begin(s); i < x.offsets.end(s); ++i) {
        for (Index h = 0; h < config.heads; ++h) {
          const Index w = config.head_width;
          auto part = [](const Matrix& t, Index row, Index rows, Index head, Index size) {
            return ml::slice(ml::slice(t, 0, row, row + rows), 1, head * size, (head + 1) * size);
          };
          const Index first = x.offsets.begin(s), seen = i + 1 - first;
          const auto share =
              ml::softmax(ml::matmul(part(q, i, 1, h, w), part(k, first, seen, h, w), {.transpose_b = true}) *
                          (1 / std::sqrt(static_cast<double>(w))));
          for (const double value : ml::matmul(share, part(v, first, seen, h, width)).to_vector()) out.push_back(value);
        }
      }
    }
    const auto expected =
        layer.layer_norm(layer.fc(Matrix::from(out, {5, config.heads * width}), ml::Activation::none, &x.rows));
    CHECK(distance(heard, expected) < 1e-12);
  }
}

TEST_CASE(
    "transformer: the gradient of a shared projection is the sum of both uses; the table of positions is not trained") {
  auto loss = [](const auto& m, const auto& memory) {
    return ml::sum(
        ml::cross_entropies(m.logits(target.without_ends(0, 1), memory), target.without_ends(1, 0).ids, 0.1));
  };
  const auto shared = small_transformer();
  auto apart = shared;
  apart.trg_word_prj = ml::LinearMap<B>();
  apart.trg_word_prj->weight = shared.decoder.symbols->weight;
  const auto a = ml::convert<A>(shared), b = ml::convert<A>(apart);
  const auto ga = ml::backward(loss(a, a.encode(source))), gb = ml::backward(loss(b, b.encode(source)));
  CHECK(distance(ga[a.decoder.symbols->weight], gb[b.decoder.symbols->weight] + gb[b.trg_word_prj->weight]) < 1e-12);
  CHECK(a.encoder.position_enc.positional_encoding.data().node == nullptr);
}

TEST_CASE("a shared projection is in files twice; a copy that is another tensor is refused") {
  const auto m = small_transformer();
  auto file = [&](const ml::Tensor<B, 2>& copy) {
    ml::TensorStore store;
    store.add_module(m, "m.", ml::DType::F64);
    store.add<double>("m.trg_word_prj.weight", copy.shape(), copy.span(), ml::DType::F64);
    return ml::safetensors_bytes(store.views());
  };
  auto loaded = small_transformer();
  loaded.decoder.symbols->weight = ml::Tensor<B, 2>::zeros({7, 8});
  const auto twice = file(m.decoder.symbols->weight), another = file(normal<B, 2>({7, 8}, 9));
  ml::load_module(loaded, ml::SafetensorsFile::from_bytes(twice), "m.");
  CHECK(distance(loaded.decoder.symbols->weight, m.decoder.symbols->weight) == 0);
  CHECK_ERROR(ml::load_module(loaded, ml::SafetensorsFile::from_bytes(another), "m."), "[motionlang.io.407]");
}

TEST_CASE("a writer says what the transformer says, for beginnings that grow, change places, multiply or are new") {
  const auto m = small_transformer();
  const auto memory = m.encode(source);
  const ml::Sequences<B> each(ml::concat(0, memory[0], memory[0], memory[1], memory[1]), Offsets{3, 3, 5, 5});
  ml::Seq2SeqWriter<B> writer(m, memory);
  auto same = [&](const std::vector<std::vector<Index>>& written) {
    const auto ids = IdSequences::from(written);
    return distance(writer(ids), m.next_logits(ids, ids.count() == 2 ? memory : each)) < 1e-12;
  };
  CHECK(same({{0}, {0}}));
  CHECK(same({{0, 3}, {0, 4}, {0, 5}, {0, 2}}));              // two beams of each source
  CHECK(same({{0, 4, 1}, {0, 3, 2}, {0, 5, 6}, {0, 5, 3}}));  // changed places, both of one parent
  CHECK(same({{0, 3, 2, 2}, {0, 4, 1, 1}, {0, 5, 3, 1}, {0, 5, 6, 1}}));
  CHECK(same({{0, 6, 6}, {0, 1, 2}}));  // nothing of this was there before
  CHECK(same({{0}, {0}}));
  CHECK_ERROR(writer(IdSequences::from({{0}, {0}, {0}})), "[motionlang.shape.205]");
  CHECK_ERROR(writer(IdSequences::from({{0, 1}, {0}})), "[motionlang.shape.205]");
  const std::vector<Index> longer(7, 0);
  CHECK_ERROR(writer(IdSequences::from({longer, longer})), "[motionlang.shape.203]");
}

TEST_CASE("cross_entropies: smoothing gives the other classes their share") {
  const auto logits = normal<B, 2>({3, 4}, 5);
  const std::vector<Index> labels{2, 0, 3};
  const auto plain = ml::cross_entropies(logits, labels), smooth = ml::cross_entropies(logits, labels, 0.1);
  for (Index i = 0; i < 3; ++i) {
    double want = 0;
    for (Index k = 0; k < 4; ++k) {
      const std::vector<Index> other(3, k);
      const double l = ml::cross_entropies(logits, other).at(i);
      want += l * (k == labels[static_cast<std::size_t>(i)] ? 0.9 : 0.1 / 3);
    }
    CHECK(smooth.span()[static_cast<std::size_t>(i)] == doctest::Approx(want).epsilon(1e-12));
  }
  CHECK(ml::cross_entropy(logits, labels).item() == doctest::Approx(ml::mean(plain).item()));
  CHECK_ERROR(ml::cross_entropies(logits, labels, 1), "[motionlang.config.101]");
}

TEST_CASE("recurrent model: published size; a text beside a longer one is attended to as if it were as long") {
  ml::NoInit none;
  const ml::Seq2SeqGru<ml::EigenBackend<float>> published({}, none);
  CHECK(ml::parameter_count(published) == 16'953'856);
  for (bool late : {false, true}) {
    const auto m = small_gru(late, 2);
    const ml::Sequences<B> words(normal<B, 2>({7, 4}, 3), Offsets{2, 5});
    auto both = m.start(words), alone = m.start(ml::Sequences<B>(words[0], Offsets{2}), 5);
    for (int step = 0; step < 3; ++step) {
      const auto a = m.step(std::vector<Index>{6, 6}, both).logits, b = m.step(std::vector<Index>{6}, alone).logits;
      CHECK(distance(ml::slice(a, 0, 0, 1), b) < 1e-13);
    }
    auto shorter = m.start(ml::Sequences<B>(words[0], Offsets{2}));
    auto again = m.start(words);
    CHECK(distance(m.step(std::vector<Index>{6}, shorter).logits,
                   ml::slice(m.step(std::vector<Index>{6, 6}, again).logits, 0, 0, 1)) > 1e-6);
  }
}

TEST_CASE("recurrent model: forced by its own choices it says what it says free; lengths may differ") {
  const auto m = small_gru();
  const ml::Sequences<B> words(normal<B, 2>({5, 4}, 4), Offsets{3, 2});
  const auto inputs = IdSequences::from({{6, 1, 2}, {6, 3}});
  const auto free = m.logits(words, inputs, false);
  CHECK(free.shape() == ml::Shape{5, 8});
  const auto chosen = ml::arg_max(free);
  const auto own = IdSequences::from({{6, chosen[0], chosen[1]}, {6, chosen[3]}});
  CHECK(distance(m.logits(words, own, true), free) < 1e-14);
  CHECK(distance(m.logits(words, inputs, true), free) > 0);
  auto state = m.start(words);
  const auto decoded = ml::decode_batch(m.next(state), 2, {.begin = 6, .end = 7, .pad = 5, .max_steps = 2});
  if (chosen[0] != 7) CHECK(decoded.ids[0][1] == chosen[0]);
  CHECK_ERROR(m.logits(words, IdSequences::from({{6}}), true), "[motionlang.shape.204]");
}

TEST_CASE("Gumbel noise of a part of a batch: the rows that the whole batch draws, in each step") {
  for (const Index symbols : {5, 8}) {
    ml::Philox rng{.seed = 6};
    const ml::GumbelNoise noise{rng, 3, symbols};
    for (Index step = 0; step < 3; ++step) {
      const auto whole = ml::gumbel_noise<B>(3, symbols, rng).to_vector();
      for (Index first = 0; first < 3; ++first) {
        for (Index count = 1; first + count <= 3; ++count) {
          const std::vector<double> rows(whole.begin() + first * symbols, whole.begin() + (first + count) * symbols);
          const auto part = noise.rows<B>(step, first, count);
          CHECK(part.shape() == ml::Shape{count, symbols});
          CHECK(std::vector<double>(part.span().begin(), part.span().end()) == rows);
        }
      }
    }
  }
}

TEST_CASE("gumbel_sample: rows are one-hot, no marks but the first, gradients reach the model") {
  const auto m = ml::convert<A>(small_gru());
  const ml::Sequences<A> words(normal<A, 2>({5, 4}, 4), Offsets{3, 2});
  ml::Philox rng{.seed = 6};
  const auto sample = ml::gumbel_sample(m, words, {.begin = 6, .end = 7, .max_steps = 4, .tau = 0.5},
                                        [&](Index) { return ml::gumbel_noise<A>(2, 8, rng); });
  const Index length = sample.one_hot.size(1);
  const auto rows = ml::reshape<2>(sample.one_hot, {2 * length, 8});
  const auto ids = ml::arg_max(rows);
  CHECK(distance(rows, ml::one_hot<B>(ids, 8)) < 1e-12);
  for (std::size_t i = 0; i < ids.size(); ++i) CHECK((ids[i] >= 6) == (i % static_cast<std::size_t>(length) == 0));
  const auto packed = sample.rows();
  CHECK(packed.offsets.length(0) == sample.lengths[0] + 1);
  const auto weights = normal<B, 2>(rows.shape(), 8);
  const auto loss = ml::sum(rows * ml::Tensor<A, 2>::from(weights.to_vector(), weights.shape()));
  if (length > 1) CHECK(ml::backward(loss).find(m.text_encoder.hidden.data()) != nullptr);
}

TEST_CASE("gumbel_sample: where all end at once there is the first mark only") {
  auto inner = small_gru();
  auto weight = inner.motion_decoder_step.input_emb.weight.to_vector();  // (8, 5)
  // every symbol is worth nothing but the end, which is worth the square of the state
  auto end_first = [&](double scale) {
    for (std::size_t i = 0; i < weight.size(); ++i) weight[i] = i / 5 == 7 ? scale : 0;
    inner.motion_decoder_step.input_emb.weight = ml::Tensor<B, 2>::from(weight, {8, 5});
    return ml::gumbel_sample(inner, ml::Sequences<B>(normal<B, 2>({2, 4}, 4), Offsets{2}), {.begin = 6, .end = 7},
                             [&](Index) {
                               return ml::Tensor<B, 2>::zeros({1, 8});
                             });
  };
  const auto up = end_first(1), down = end_first(-1);  // one of both makes the end the largest logit
  const auto& ended = up.lengths[0] == 0 ? up : down;
  CHECK(ended.lengths == std::vector<Index>{0});
  CHECK(ended.one_hot.shape() == ml::Shape{1, 1, 8});
  const auto rows = ended.rows();
  CHECK(rows.rows.span()[6] == 1);
}
