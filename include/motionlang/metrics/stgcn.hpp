// SPDX-License-Identifier: MIT
/// ST-GCN: a classifier of motions by convolutions over a skeleton's graph and over time. It judges ACTOR's motions on
/// UESTC, and measures the value of generated motions as training data.
///
/// Source  Yan, Xiong, Lin: "Spatial temporal graph convolutional networks for skeleton-based action recognition" (AAAI
///         2018); ACTOR, src/recognition/models/stgcn.py, whose keys are the field names
#pragma once

#include <motionlang/metrics/gru_classifier.hpp>
#include <motionlang/nn/batch_norm.hpp>
#include <motionlang/nn/conv1d.hpp>
#include <motionlang/nn/pooling.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The tree with loops, every column divided by its degree, in three parts: 0 the loops, 2 the edges (row, column) away
/// from the centre, 1 the others. (3, joints, joints), row by row.
/// Differs  from the paper: distances from the centre beyond 1 count as infinite, and so as equal; such edges are in
///          part 1
/// Throws   config_error 101 if the centre is not a joint
std::vector<double> stgcn_adjacency(std::span<const int> parents, Index centre);

/// A convolution (kernel, 1) of PyTorch over (time, joints): over time, each joint by itself; "same" padding.
template <Backend B>
struct TemporalConv {
  Tensor<B, 4> weight;  // (out, in, kernel, 1)
  Tensor<B, 1> bias;    // (out)
  Index stride = 1;

  static constexpr auto fields() {
    using M = TemporalConv;
    return motionlang::fields("weight", &M::weight, "bias", &M::bias, "stride", &M::stride);
  }
  TemporalConv() = default;
  TemporalConv(Index in, Index out, Index kernel, Index step, Rng auto& rng) : stride(step) {
    const double bound = 1 / std::sqrt(static_cast<double>(in * kernel));
    weight = uniform_init<B, 4>({out, in, kernel, 1}, bound, rng);
    bias = uniform_init<B, 1>({out}, bound, rng);
  }
  Index out() const { return weight.size(0); }

  Sequences<B> operator()(const Sequences<B>& x) const {
    const ModuleScope scope(*this);
    const Index kernel = weight.size(2);
    return conv1d(x, reshape<3>(weight, {out(), weight.size(1), kernel}), &bias,
                  {.stride = stride, .padding = kernel / 2});
  }
};

/// One layer: a convolution over the graph, one over time, and a residual connection.
///     y_w = sum_k sum_v (W_k x_v) (A_k M_k)_vw,   out = relu(residual(x) + BN(conv(relu(BN(y)))))
/// Rows are ordered by joint, then sequence, then frame: every joint of every motion is a sequence of its own.
template <Backend B>
struct StGcnBlock {
  TemporalConv<B> gcn, tcn;
  BatchNorm<B> before, after;  // of the convolution over time
  std::optional<TemporalConv<B>> shortcut;
  std::optional<BatchNorm<B>> shortcut_norm;
  bool residual = true;

  static constexpr auto fields() {
    using M = StGcnBlock;
    return motionlang::fields("gcn.conv", &M::gcn, "tcn.0", &M::before, "tcn.2", &M::tcn, "tcn.3", &M::after,
                              "residual.0", &M::shortcut, "residual.1", &M::shortcut_norm, "has_residual",
                              &M::residual);
  }
  StGcnBlock() = default;
  StGcnBlock(Index in, Index out, Index stride, bool with_residual, Rng auto& rng)
      : gcn(in, 3 * out, 1, 1, rng), tcn(out, out, 9, stride, rng), before(out), after(out), residual(with_residual) {
    if (!residual || (in == out && stride == 1)) return;
    shortcut.emplace(in, out, 1, stride, rng);
    shortcut_norm.emplace(out);
  }

  /// edges (3, joints, joints): A M. `Self` is constant after training; in training norms use the statistics of
  /// the batch.
  template <class Self>
  static Sequences<B> run(Self& self, const Sequences<B>& x, const Tensor<B, 3>& edges, const Context& context = {}) {
    const ModuleScope scope(self);
    const Index joints = edges.size(1), out = self.tcn.out(), rows = x.offsets.rows(), each = rows / joints * out;
    const auto parts = permute(reshape<3>(self.gcn(x).rows, {rows, 3, out}), {1, 0, 2});
    const auto mixed =
        matmul(reshape<2>(edges, {3 * joints, joints}), reshape<2>(parts, {3 * joints, each}), {.transpose_a = true});
    auto norm = [&](auto& n, const Tensor<B, 2>& t) { return batch_norm(n, t, context); };
    auto y = self.tcn(x.with(activate(norm(self.before, reshape<2>(mixed, {rows, out})), Activation::relu)));
    y.rows = norm(self.after, y.rows);
    if (self.shortcut)
      y.rows = y.rows + norm(*self.shortcut_norm, (*self.shortcut)(x).rows);
    else if (self.residual)
      y.rows = y.rows + x.rows;
    return y.with(activate(y.rows, Activation::relu));
  }
  Sequences<B> operator()(const Sequences<B>& x, const Tensor<B, 3>& edges) const { return run(*this, x, edges); }
};

/// The graph of a model. It is saved and loaded, but not trained.
template <Backend B>
struct SkeletonGraph {
  static constexpr bool trainable = false;
  Tensor<B, 3> A;  // (3, joints, joints)
  static constexpr auto fields() { return motionlang::fields("A", &SkeletonGraph::A); }
};

struct StGcnConfig {
  std::vector<int> parents{-1, 0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 9, 9, 12, 13, 14, 16, 17, 18, 19, 20, 21};  // SMPL
  Index centre = 0;
  Index in_channels = 6;
  Index num_classes = 40;
  std::vector<Index> channels{64, 64, 64, 64, 128, 128, 128, 256, 256, 256};
  std::vector<Index> strides{1, 1, 1, 1, 2, 1, 1, 2, 1, 1};

  /// SMPL's tree without the global rotation of joint 0 (layout "smpl_noglobal"): the legs and the spine are not
  /// connected, and the centre is the left hip.
  static std::vector<int> without_root(std::span<const int> parents);
};

template <Backend B>
struct StGcn {
  SkeletonGraph<B> graph;
  BatchNorm<B> data_bn;  // of every value of a frame
  std::vector<StGcnBlock<B>> st_gcn_networks;
  std::vector<Tensor<B, 3>> edge_importance;  // M of each block, (3, joints, joints)
  TemporalConv<B> fcn;                        // (classes, channels, 1, 1)

  static constexpr auto fields() {
    using M = StGcn;
    return motionlang::fields("", &M::graph, "data_bn", &M::data_bn, "st_gcn_networks", &M::st_gcn_networks,
                              "edge_importance", &M::edge_importance, "fcn", &M::fcn);
  }
  StGcn() = default;
  /// Throws config_error 101 unless there is a stride for each width.
  StGcn(const StGcnConfig& c, Rng auto& rng) : data_bn(std::ssize(c.parents) * c.in_channels) {
    if (c.channels.empty() || c.channels.size() != c.strides.size())
      raise<config_error>(101, "StGcn: ", c.strides.size(), " strides for ", c.channels.size(), " blocks");
    const Index joints = std::ssize(c.parents);
    const auto numbers = stgcn_adjacency(c.parents, c.centre);
    graph.A = Tensor<B, 3>::from(std::vector<typename B::scalar>(numbers.begin(), numbers.end()), {3, joints, joints});
    Index in = c.in_channels;
    for (std::size_t i = 0; i < c.channels.size(); ++i) {
      st_gcn_networks.emplace_back(in, c.channels[i], c.strides[i], i > 0, rng);
      edge_importance.push_back(constant_init<B, 3>({3, joints, joints}, 1));
      in = c.channels[i];
    }
    fcn = TemporalConv<B>(in, c.num_classes, 1, 1, rng);
  }
  Index joints() const { return graph.A.size(1); }

  /// x: frames, joint by joint. Features (sequences, width of the last block), logits (sequences, classes).
  Recognition<B> operator()(const Sequences<B>& x) const { return run(*this, x, {}); }
  /// The same with the statistics of the batch, which the norms store.
  Recognition<B> train(const Sequences<B>& x, const Context& context = {}) { return run(*this, x, context); }

  /// The input of the first block: normalised, with every joint as a sequence of its own.
  template <class Self>
  static Sequences<B> joint_sequences(Self& self, const Sequences<B>& x, const Context& context = {}) {
    const Index joints = self.joints(), channels = x.width() / joints, rows = x.offsets.rows();
    const auto split = reshape<3>(batch_norm(self.data_bn, x.rows, context), {rows, joints, channels});
    PoolVector<Index> lengths;
    for (Index j = 0; j < joints; ++j) {
      for (Index s = 0; s < x.count(); ++s) lengths.push_back(x.offsets.length(s));
    }
    return {reshape<2>(permute(split, {1, 0, 2}), {joints * rows, channels}), Offsets(std::span<const Index>(lengths))};
  }

 private:
  template <class Self>
  static Recognition<B> run(Self& self, const Sequences<B>& x, const Context& context) {
    const ModuleScope scope(self);
    auto y = joint_sequences(self, x, context);
    for (std::size_t i = 0; i < self.st_gcn_networks.size(); ++i)
      y = StGcnBlock<B>::run(self.st_gcn_networks[i], y, self.graph.A * self.edge_importance[i], context);
    const Index joints = self.joints();
    const auto features = mean(reshape<3>(mean_rows(y), {joints, x.count(), y.width()}), 0);
    return {features, self.fcn(Sequences<B>(features, Offsets::equal(x.count(), 1))).rows};
  }
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/metrics/stgcn.ipp>
#endif
