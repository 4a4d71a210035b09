// The text networks against the numbers of the reference implementations: every number of
// tests/support/network_numbers.hpp.
#include <doctest/doctest.h>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>
#include <motionlang/file/json.hpp>

#include "../../support/network_numbers.hpp"
#include "../../support/tensors.hpp"
#include "../../support/text_networks.hpp"

namespace ml = motionlang;
using namespace text_networks;

namespace {

/// Rounding of the numbers in the list, or of the scalar.
template <ml::Backend B>
constexpr double tolerance = sizeof(typename B::scalar) == 8 ? 1e-8 : 2e-6;

template <ml::Backend B>
double distance(const ml::Tensor<B, 2>& got, const nlohmann::json& rows) {
  std::vector<double> values;
  for (const auto& row : rows) values.insert(values.end(), row.begin(), row.end());
  const auto count = static_cast<Index>(rows.size());
  return tensors::distance(got, ml::Tensor<ml::ReferenceBackend<double>, 2>::from(
                                    values, {count, static_cast<Index>(values.size()) / count}));
}
template <ml::Backend B>
ml::Tensor<B, 2> row(const ml::Tensor<B, 2>& x, Index i) {
  return ml::slice(x, 0, i, i + 1);
}

/// The numbers that the whole family has; the two samples go through the network together.
template <ml::Backend B, class Keys>
void check_family(const char* text, const ml::TokenBatch& batch) {
  const auto want = nlohmann::json::parse(text);
  CHECK(bert_shapes<Keys>().size() == want["nkeys"]);
  const auto network = tiny<B, Keys>();
  const auto states = network(batch).tokens;
  CHECK(distance(states[0], want["last0"]) < tolerance<B>);
  CHECK(distance(states[1], want["last1_valid"]) < tolerance<B>);
  auto first = network;
  first.layers.resize(1);
  CHECK(distance(row(first(batch).tokens.rows, 0), want["layer0_row0"]) < tolerance<B>);
  first.layers.clear();
  CHECK(distance(row(first(batch).tokens.rows, 0), want["emb_row0"]) < tolerance<B>);
  if (want.contains("sentence")) {
    const auto sentence = ml::normalize_rows(ml::pool(network(batch), ml::Pooling::mean));
    CHECK(distance(sentence, want["sentence"]) < tolerance<B>);
  }
}

}  // namespace

TEST_CASE_TEMPLATE("DistilBERT", B, ml::ReferenceBackend<double>, ml::EigenBackend<float>, ml::XtensorBackend<float>) {
  const ml::TokenBatch batch{{2, 7, 3, 19, 5, 2, 9, 3}, {5, 3}};
  check_family<B, ml::DistilBertKeys>(network_numbers::distilbert, batch);

  auto network = tiny<B, ml::DistilBertKeys>();
  const auto layer = network.layers[0];
  network.layers.clear();
  const auto x = network(batch).tokens[0];
  const auto q = ml::slice(row(layer.query(x), 0), 1, 0, 4), k = ml::slice(layer.key(x), 1, 0, 4);  // of head 0
  const auto weights = ml::softmax(ml::matmul(q, k, {.transpose_b = true}) * 0.5);
  const auto want = nlohmann::json::parse(network_numbers::distilbert);
  CHECK(distance(weights, nlohmann::json::array({want["attn_l0_h0_q0"]})) < tolerance<B>);
}

TEST_CASE_TEMPLATE("BERT", B, ml::ReferenceBackend<double>, ml::EigenBackend<float>, ml::XtensorBackend<float>) {
  check_family<B, ml::BertKeys>(network_numbers::bert, {{2, 7, 3, 19, 5, 2, 9, 3}, {5, 3}});
}

TEST_CASE_TEMPLATE("MPNet", B, ml::ReferenceBackend<double>, ml::EigenBackend<float>, ml::XtensorBackend<float>) {
  check_family<B, ml::MpnetKeys>(network_numbers::mpnet, {{0, 7, 3, 19, 2, 0, 9, 2}, {5, 3}});

  const auto table = tiny<B, ml::MpnetKeys>().relative_scores->weight;
  std::vector<Index> buckets;
  for (Index i = 0; i < 5; ++i) {
    for (Index j = 0; j < 5; ++j) buckets.push_back(ml::mpnet_bucket(j - i));
  }
  const auto scores = ml::reshape<2>(ml::slice(ml::gather(table, buckets), 1, 0, 1), {5, 5});
  CHECK(distance(scores, nlohmann::json::parse(network_numbers::mpnet)["bias_h0"]) < tolerance<B>);
}

TEST_CASE_TEMPLATE("RoBERTa is BERT with one token type, whose positions count from behind that of padding", B,
                   ml::ReferenceBackend<double>, ml::EigenBackend<float>, ml::XtensorBackend<float>) {
  auto numbers = by_formula(bert_shapes<ml::BertKeys>());
  const auto width = static_cast<std::size_t>(tiny_bert.width);
  auto& types = numbers.at("embeddings.token_type_embeddings.weight");
  types.first[0] = 1;
  types.second.resize(width);
  const auto bert_of = [&](const Numbers& from) {
    auto config = tiny_bert;
    config.token_types = 1;
    return ml::load_text_network<ml::Bert<B>>(config, file_of(from));
  };
  const auto bert = bert_of(numbers);
  auto moved = numbers;
  auto& positions = moved.at("embeddings.position_embeddings.weight");
  positions.second.insert(positions.second.begin(), 2 * width, 9.0);  // of ids 0 and 1, which no text has
  positions.second.resize(positions.second.size() - 2 * width);
  Numbers prefixed;
  for (const auto& [name, t] : moved) prefixed["roberta." + name] = t;
  auto config = tiny_bert;
  config.token_types = 1, config.padding = 1;
  const auto roberta = ml::load_text_network<ml::Roberta<B>>(config, file_of(prefixed));
  CHECK(roberta.longest() == tiny_bert.positions - 2);
  const ml::TokenBatch batch{{0, 7, 3, 19, 2, 0, 9, 2}, {5, 3}};
  const auto as_bert = bert(batch).tokens.rows.to_vector(), as_roberta = roberta(batch).tokens.rows.to_vector();
  CHECK(as_bert == as_roberta);
}

TEST_CASE("the borders of MPNet's buckets") {
  const std::vector<std::pair<Index, Index>> first_of{{8, 8},   {12, 9},  {16, 10}, {23, 11},
                                                      {32, 12}, {46, 13}, {64, 14}, {91, 15}};
  for (const auto& [distance, bucket] : first_of) {
    CHECK(ml::mpnet_bucket(-distance) == bucket);
    CHECK(ml::mpnet_bucket(distance) == 16 + bucket);
    CHECK(ml::mpnet_bucket(1 - distance) == bucket - 1);
  }
  CHECK(ml::mpnet_bucket(0) == 0);
  CHECK(ml::mpnet_bucket(1) == 17);
  CHECK(ml::mpnet_bucket(-100000) == 15);
}

TEST_CASE_TEMPLATE("CLIP", B, ml::ReferenceBackend<double>, ml::EigenBackend<float>, ml::XtensorBackend<float>) {
  const auto want = nlohmann::json::parse(network_numbers::clip);
  CHECK(clip_shapes().size() == want["nkeys"]);
  const ml::TokenBatch batch{{18, 3, 7, 5, 19, 0, 0, 0, 0, 18, 4, 4, 2, 9, 11, 13, 6, 19}, {9, 9}};
  const auto network = tiny_clip_text<B>();
  auto x = network.token_embedding(batch.ids);
  x = x + ml::concat(0, network.positional_embedding, network.positional_embedding);
  CHECK(distance(row(x, 0), want["emb_row0"]) < tolerance<B>);
  x = network.blocks[0](x, ml::Offsets{9, 9});
  CHECK(distance(row(x, 0), want["block0_row0"]) < tolerance<B>);
  CHECK(distance(row(x, 4), want["block0_row4"]) < tolerance<B>);
  x = network.blocks[1](x, ml::Offsets{9, 9});
  CHECK(distance(row(x, 4), want["block1_row4"]) < tolerance<B>);

  const auto text = network(batch);
  CHECK(text.end_position == std::vector<Index>{4, 8});
  const auto vectors = network.project(ml::pool(text, ml::Pooling::end));
  CHECK(distance(vectors, want["text"]) < tolerance<B>);
  const auto short_batch = network.until_end(batch);
  CHECK(short_batch.lengths == std::vector<Index>{5, 9});
  CHECK(tensors::same_bits(network.project(ml::pool(network(short_batch), ml::Pooling::end)), vectors));
}
