// Classifiers of motions: published names and sizes, the graph, packed motions as alone, training.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/loss/cross_entropy.hpp>
#include <motionlang/metrics/stgcn.hpp>
#include <motionlang/optim/adamw.hpp>

#include "../../support/check_error.hpp"
#include "../../support/tensors.hpp"

namespace ml = motionlang;
using ml::Index, ml::Offsets;
using B = ml::EigenBackend<float>;
using A = ml::Autodiff<ml::EigenBackend<float>>;
using tensors::distance, tensors::normal;

namespace {

const ml::StGcnConfig small{.in_channels = 3, .num_classes = 3, .channels = {4, 6}, .strides = {1, 2}};

double edge(const std::vector<double>& a, std::size_t part, std::size_t i, std::size_t j, std::size_t joints = 24) {
  return a[(part * joints + i) * joints + j];
}

}  // namespace

TEST_CASE("st-gcn: names and sizes of the published model") {
  ml::NoInit zeros;
  const ml::StGcn<B> model({}, zeros);
  std::map<std::string, ml::Shape> shapes;
  Index buffers = 0;
  ml::visit_tensors(model, [&](const std::string& path, const auto& t) {
    shapes.emplace(path, t.shape());
    if (path == "A" || path.find("running") != path.npos || path.find("tracked") != path.npos) buffers += t.count();
  });
  CHECK(ml::parameter_count(model) - buffers == 3092936);
  CHECK(shapes.at("A") == ml::Shape{3, 24, 24});
  CHECK(shapes.at("data_bn.running_mean") == ml::Shape{144});
  CHECK(shapes.at("st_gcn_networks.4.gcn.conv.weight") == ml::Shape{384, 64, 1, 1});
  CHECK(shapes.at("st_gcn_networks.9.tcn.2.weight") == ml::Shape{256, 256, 9, 1});
  CHECK(shapes.at("st_gcn_networks.7.residual.1.running_var") == ml::Shape{256});
  CHECK(shapes.at("edge_importance.3") == ml::Shape{3, 24, 24});
  CHECK(shapes.at("fcn.weight") == ml::Shape{40, 256, 1, 1});
  CHECK_FALSE(shapes.contains("st_gcn_networks.0.residual.0.weight"));
  CHECK_FALSE(shapes.contains("st_gcn_networks.1.residual.0.weight"));
}

TEST_CASE("gru classifier: names and sizes of the published model") {
  ml::NoInit zeros;
  const ml::GruClassifier<B> model({}, zeros);
  std::map<std::string, ml::Shape> shapes;
  ml::visit_tensors(model, [&](const std::string& path, const auto& t) {
    shapes.emplace(ml::GruClassifier<B>::official_key(path), t.shape());
  });
  CHECK(shapes.size() == 12);
  CHECK(shapes.at("recurrent.weight_ih_l0") == ml::Shape{384, 72});
  CHECK(shapes.at("recurrent.weight_hh_l1") == ml::Shape{384, 128});
  CHECK(shapes.at("linear1.weight") == ml::Shape{30, 128});
  CHECK(shapes.at("linear2.bias") == ml::Shape{12});
}

TEST_CASE("st-gcn: loops, edges away from the centre, other edges") {
  const auto a = ml::stgcn_adjacency(ml::StGcnConfig{}.parents, 0);
  CHECK(edge(a, 0, 9, 9) == doctest::Approx(0.2));
  CHECK(edge(a, 2, 0, 1) == doctest::Approx(1.0 / 3));
  CHECK(edge(a, 2, 1, 4) == doctest::Approx(1.0 / 3));
  CHECK(edge(a, 1, 1, 0) == doctest::Approx(0.25));
  CHECK(edge(a, 1, 4, 7) == doctest::Approx(1.0 / 3));
  int outward = 0;
  for (std::size_t i = 2 * 576; i < 3 * 576; ++i) outward += a[i] != 0 ? 1 : 0;
  CHECK(outward == 6);
  // without the pelvis the left hip is the centre: left knee, then left ankle
  const auto parents = ml::StGcnConfig::without_root(ml::StGcnConfig{}.parents);
  const auto b = ml::stgcn_adjacency(parents, 0);
  for (std::size_t i = 0; i < 23; ++i) {
    for (std::size_t j = 0; j < 23; ++j)
      CHECK((edge(b, 2, i, j, 23) != 0) == ((i == 0 && j == 3) || (i == 3 && j == 6)));
  }
  CHECK_ERROR(ml::stgcn_adjacency(parents, 23), "[motionlang.config.101]");
}

TEST_CASE("classifiers: a motion in a batch is judged as if it were alone") {
  ml::Philox rng{.seed = 1};
  const ml::StGcn<B> graph(small, rng);
  const ml::GruClassifier<B> recurrent({.hidden_size = 8, .num_classes = 3}, rng);
  const ml::Sequences<B> x(normal<B, 2>({25, 72}, 2), Offsets{9, 16});
  const auto by_graph = graph(x).logits, by_steps = recurrent(x).logits;
  for (Index s : {0, 1}) {
    const ml::Sequences<B> one(x[s], Offsets{x.offsets.length(s)});
    CHECK(distance(graph(one).logits, ml::slice(by_graph, 0, s, s + 1)) < 1e-5);
    CHECK(distance(recurrent(one).logits, ml::slice(by_steps, 0, s, s + 1)) < 1e-5);
  }
  const auto h0 = recurrent.initial_state(2, rng);
  CHECK(h0.shape() == ml::Shape{2, 2, 8});
  CHECK(distance(recurrent(x, &h0).logits, by_steps) > 1e-4);
}

TEST_CASE("classifiers learn which of three kinds a motion is") {
  // Kind k swings number k of every joint.
  std::vector<float> numbers;
  std::vector<Index> labels;
  ml::Philox rng{.seed = 3};
  for (Index i = 0; i < 12; ++i) {
    labels.push_back(i % 3);
    const double phase = 6 * rng.uniform();
    for (int t = 0; t < 12; ++t) {
      for (int c = 0; c < 72; ++c)
        numbers.push_back(c % 3 == labels.back() ? static_cast<float>(std::sin(phase + t)) : 0.0F);
    }
  }
  const auto x = ml::Sequences<A>(ml::Tensor<A, 2>::from(numbers, {144, 72}), Offsets::equal(12, 12));
  auto learns = [&](auto model, auto classify) {
    ml::AdamW<A> adam({.lr = 0.01});
    double first = 0, last = 0;
    for (int step = 0; step < 80; ++step) {
      const auto loss = ml::cross_entropy(classify(model), labels);
      last = static_cast<double>(loss.item());
      if (step == 0) first = last;
      adam.step(model, ml::backward(loss));
    }
    CHECK(first > 0.5);
    CHECK(last < 0.2 * first);
    return model;
  };
  const auto graph = learns(ml::convert<A>(ml::StGcn<B>(small, rng)), [&](auto& m) { return m.train(x).logits; });
  learns(ml::convert<A>(ml::GruClassifier<B>({.hidden_size = 8, .num_classes = 3}, rng)),
         [&](auto& m) { return m(x).logits; });
  CHECK(graph.data_bn.statistics.num_batches_tracked.item() == 80);
  const auto used = ml::to_inner(graph);  // now with running statistics
  const auto logits = used(ml::Sequences<B>(ml::Tensor<B, 2>::from(numbers, {144, 72}), x.offsets)).logits;
  int right = 0;
  for (std::size_t i = 0; i < 12; ++i) {
    const auto row = logits.span().subspan(3 * i, 3);
    right += std::max_element(row.begin(), row.end()) - row.begin() == labels[i] ? 1 : 0;
  }
  CHECK(right >= 10);
}
