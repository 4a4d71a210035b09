// Text networks: batches, order of words, lengths; pooling; encoders made of a tokenizer and a network.
#include <doctest/doctest.h>

#include <map>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/nn/pooling.hpp>
#include <motionlang/text/tokenized_encoder.hpp>
#include <motionlang/text/word_piece.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tensors.hpp"
#include "../../support/text_networks.hpp"

namespace ml = motionlang;
using B = ml::EigenBackend<float>;
using tensors::same_bits;
using namespace text_networks;

namespace {

/// One id for every letter, framed by 2 and 3; letters beyond p are one.
struct Letters {
  std::vector<Index> encode(std::string_view text) const {
    std::vector<Index> ids{2};
    for (char c : text) ids.push_back(4 + std::clamp<Index>(c - 'a', 0, 14));
    ids.push_back(3);
    return ids;
  }
  Index size() const { return 20; }
};
/// The same, with the largest id at the end, as CLIP wants.
struct ClipLetters : Letters {
  std::vector<Index> encode(std::string_view text) const {
    auto ids = Letters::encode(text);
    ids.back() = 19;
    return ids;
  }
};
static_assert(ml::Tokenizer<Letters>);

void check_batches(const auto& network) {
  const std::vector<std::vector<Index>> texts{{2, 5, 6, 3}, {2, 3}, {2, 6, 5, 3}, {2, 9, 9, 9, 9, 9, 3}};
  ml::TokenBatch all;
  // of 17 rows: more than one group goes through the layers
  for (Index copies = B::rows_in_cache() / 12; copies > 0; --copies) {
    for (const auto& t : texts) {
      all.ids.insert(all.ids.end(), t.begin(), t.end());
      all.lengths.push_back(std::ssize(t));
    }
  }
  const auto together = network(all).tokens;
  for (Index i = 0; i < together.count(); ++i) {
    const auto& text = texts[static_cast<std::size_t>(i) % texts.size()];
    CHECK(same_bits(network(ml::TokenBatch{text, {std::ssize(text)}}).tokens.rows, together[i]));
  }
  CHECK(tensors::distance(ml::slice(together[0], 0, 3, 4), ml::slice(together[2], 0, 3, 4)) > 1e-3);  // swapped words
  CHECK(network(ml::TokenBatch{}).count() == 0);
  CHECK_ERROR(network(ml::TokenBatch{{2, 20, 3}, {3}}), "[motionlang.shape.203]");
  const auto too_long = static_cast<std::size_t>(network.longest()) + 1;
  CHECK_ERROR(network(ml::TokenBatch{{2, 3}, {3}}), "[motionlang.shape.207]");
  CHECK_ERROR(network(ml::TokenBatch{std::vector<Index>(too_long, 5), {network.longest() + 1}}),
              "[motionlang.config.101]");
}

}  // namespace

TEST_CASE("a text has the same bits alone and in a batch; words have an order; long texts are refused") {
  check_batches(tiny<B, ml::DistilBertKeys>());
  check_batches(tiny<B, ml::BertKeys>());
  check_batches(tiny<B, ml::MpnetKeys>());
  check_batches(tiny_clip_text<B>());
  CHECK(tiny<B, ml::DistilBertKeys>().longest() == 16);
  CHECK(tiny<B, ml::MpnetKeys>().longest() == 14);  // rows 0 and 1 are of padding
}

TEST_CASE_TEMPLATE("networks of the BERT family are trained: gradients are central differences", Keys,
                   ml::DistilBertKeys, ml::BertKeys) {
  using D = ml::ReferenceBackend<double>;
  using A = ml::Autodiff<D>;
  auto network = tiny<D, Keys>();
  const ml::TokenBatch batch{{2, 5, 6, 3, 2, 9, 3}, {4, 3}};
  const auto weights = tensors::normal<D, 2>({7, tiny_bert.width}, 3).to_vector();
  const auto loss = [&]<class C>(const ml::BertNetwork<C, Keys>& n) {
    const auto rows = n(batch).tokens.rows;
    return ml::sum(rows * ml::Tensor<C, 2>::from(weights, rows.shape()));
  };
  ml::BertNetwork<A, Keys> taped;
  ml::detail::convert_module(taped, network);
  const auto gradients = ml::backward(loss(taped));
  std::map<std::string, std::vector<double>> found;
  ml::visit_tensors(taped, [&](const std::string& path, const auto& t) { found[path] = gradients[t].to_vector(); });
  ml::visit_tensors(network, [&]<int R>(const std::string& path, ml::Tensor<D, R>& t) {
    CAPTURE(path);
    const auto here = t;
    const auto values = t.to_vector();
    double largest = 0;
    for (std::size_t i = 0; i < values.size(); i += 7) {
      const auto moved = [&](double h) {
        auto v = values;
        v[i] += h;
        t = ml::Tensor<D, R>::from(v, here.shape());
        return loss(network).item();
      };
      const double difference = (moved(1e-5) - moved(-1e-5)) / 2e-5;
      CHECK(found[path][i] == doctest::Approx(difference).epsilon(1e-5));
      largest = std::max(largest, std::abs(difference));
    }
    t = here;
    if (path != "embeddings.position_embeddings.weight" && !path.ends_with("bias")) CHECK(largest > 1e-6);
  });
}

TEST_CASE("dropout of the BERT family: only with a context, and by its generator alone") {
  const auto network = tiny<B, ml::DistilBertKeys>();
  const ml::TokenBatch batch{{2, 5, 6, 3}, {4}};
  const auto rows = [&](const ml::Context& context) { return network(batch, context).tokens.rows; };
  const ml::Philox first{.seed = 1}, second{.seed = 2};
  CHECK(same_bits(rows({}), network(batch).tokens.rows));
  CHECK(same_bits(rows({.dropout = first}), rows({.dropout = first})));
  CHECK(tensors::distance(rows({.dropout = first}), rows({})) > 1e-3);
  CHECK(tensors::distance(rows({.dropout = first}), rows({.dropout = second})) > 1e-3);
  auto certain = network;
  certain.dropout_p = 0;
  for (auto& layer : certain.layers) layer.dropout_p = 0;
  CHECK(tensors::distance(certain(batch, {.dropout = first}).tokens.rows, rows({})) < 1e-6);
}

TEST_CASE("MPNet counts positions by ids: padding inside of a text has none") {
  const auto network = tiny<B, ml::MpnetKeys>();
  auto positions_only = network;
  positions_only.layers.clear();
  const auto x = positions_only(ml::TokenBatch{{0, 1, 7, 2}, {4}}).tokens.rows;
  const auto y = positions_only(ml::TokenBatch{{0, 7, 2}, {3}}).tokens.rows;
  CHECK(same_bits(ml::slice(x, 0, 2, 4), ml::slice(y, 0, 1, 3)));
}

TEST_CASE("a piece of padding behind a text attends to the text and not to itself") {
  auto network = tiny<B, ml::DistilBertKeys>();
  const ml::TokenBatch two{{2, 5, 6, 3, 2, 9, 3}, {4, 3}}, second{{2, 9, 3}, {3}};
  CHECK(tensors::distance(network.padding_states(second, 5), ml::slice(network.padding_states(two, 5), 0, 1, 2)) <
        1e-6);
  CHECK(tensors::distance(network.padding_states(second, 6), network.padding_states(second, 5)) > 1e-3);
  CHECK_ERROR(network.padding_states(second, 16), "[motionlang.config.101] distilbert: a text of 17 pieces");

  const auto layer = network.layers[0];
  network.layers.clear();
  const auto x = network(second).tokens.rows, pad = network.padding_states(second, 5);
  CHECK(same_bits(pad, network.norm(network.words(std::vector<Index>{0}) + network.positions(std::vector<Index>{5}))));
  const auto q = layer.query(pad), k = layer.key(x), v = layer.value(x);
  const auto head = [&](Index first) {
    const auto of_head = [&](const ml::Tensor<B, 2>& t) { return ml::slice(t, 1, first, first + 4); };
    return ml::matmul(ml::softmax(ml::matmul(of_head(q), of_head(k), {.transpose_b = true}) * 0.5), of_head(v));
  };
  const auto y = layer.attended_norm(layer.attended(ml::concat(1, head(0), head(4))) + pad);
  network.layers.push_back(layer);
  CHECK(tensors::distance(network.padding_states(second, 5),
                          layer.norm(layer.down(layer.up(y, layer.activation)) + y)) < 1e-5);
}

TEST_CASE("ids behind the end token have no influence on CLIP's vector") {
  const auto network = tiny_clip_text<B>();
  const auto vector = [&](std::vector<Index> ids) {
    return network.project(ml::pool(network(ml::TokenBatch{std::move(ids), {7}}), ml::Pooling::end));
  };
  CHECK(same_bits(vector({18, 3, 19, 0, 0, 0, 0}), vector({18, 3, 19, 5, 6, 7, 8})));
  CHECK_FALSE(same_bits(vector({18, 3, 19, 0, 0, 0, 0}), vector({18, 4, 19, 0, 0, 0, 0})));
}

TEST_CASE("pooling: mean, first, end") {
  const ml::Sequences<B> rows(ml::Tensor<B, 2>::from({1, 2, 3, 4, 5, 6}, {3, 2}), ml::Offsets{1, 2});
  const auto pooled = [&](ml::Pooling p, std::vector<Index> end = {}) {
    return ml::pool(ml::TextFeatures<B>{rows, std::move(end)}, p).to_vector();
  };
  CHECK(pooled(ml::Pooling::mean) == std::vector<float>{1, 2, 4, 5});
  CHECK(pooled(ml::Pooling::first) == std::vector<float>{1, 2, 3, 4});
  CHECK(pooled(ml::Pooling::end) == std::vector<float>{1, 2, 5, 6});
  CHECK(pooled(ml::Pooling::end, {0, 0}) == std::vector<float>{1, 2, 3, 4});
  CHECK_ERROR(pooled(ml::Pooling::end, {0, 2}), "[motionlang.shape.203]");
  CHECK_ERROR(pooled(ml::Pooling::end, {0}), "[motionlang.shape.204]");
  CHECK_ERROR(pooled(ml::Pooling::none), "[motionlang.config.101]");
  const ml::Sequences<B> none(ml::Tensor<B, 2>::zeros({0, 2}), ml::Offsets{0});
  CHECK(ml::mean_rows(none).to_vector() == std::vector<float>{0, 0});
  CHECK_ERROR(ml::pool(ml::TextFeatures<B>{none}, ml::Pooling::first), "[motionlang.shape.203]");
}

TEST_CASE("a tokenizer and a network are a text encoder") {
  const std::vector<std::string> texts{"walk", "", "jump"};
  const ml::TokenizedEncoder tokens(Letters{}, tiny<B, ml::DistilBertKeys>());
  static_assert(ml::TextEncoder<decltype(tokens), B>);
  const auto features = tokens.encode<B>(texts);
  CHECK(features.tokens.offsets == ml::Offsets{6, 2, 6});
  CHECK(features.tokens.width() == 8);

  const ml::TokenizedEncoder sentences(Letters{}, tiny<B, ml::MpnetKeys>(),
                                       {.pooling = ml::Pooling::mean, .normalize = true});
  const auto vectors = sentences.encode<B>(texts).tokens.rows;
  CHECK(vectors.shape() == ml::Shape{3, 8});
  for (float norm : ml::sum(ml::square(vectors), 1).to_vector()) CHECK(norm == doctest::Approx(1));

  const ml::TokenizedEncoder clip(ClipLetters{}, tiny_clip_text<B>(), {.pooling = ml::Pooling::end});
  const auto projected = clip.encode<B>(texts).tokens.rows;
  CHECK(projected.shape() == ml::Shape{3, 6});
  CHECK_FALSE(same_bits(ml::slice(projected, 0, 0, 1), ml::slice(projected, 0, 2, 3)));

  const ml::TokenizedEncoder all(ClipLetters{}, tiny_clip_text<B>(), {.width = 9});  // as MotionDiffuse takes them
  const auto states = all.encode<B>(texts);
  CHECK(states.tokens.offsets == ml::Offsets::equal(3, 9));
  CHECK(states.end_position == std::vector<Index>{5, 1, 5});
  CHECK(same_bits(all.network.project(ml::pool(states, ml::Pooling::end)), projected));
}
