// SPDX-License-Identifier: MIT
/// Layers whose inner values are recomputed in the backward pass, if the context enables it.
#pragma once

#include <motionlang/core/context.hpp>
#include <motionlang/tensor/gradient.hpp>
#include <motionlang/tensor/sequences.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Calls layer(x, offsets, context). With `context.recompute` the graph keeps only x and a copy of the layer's handles.
/// The inner values are recomputed with the same dropout masks, so gradients have the same bits.
template <class Layer, Backend B>
Tensor<B, 2> run_layer(const Layer& layer, const Tensor<B, 2>& x, const Offsets& offsets, const Context& context) {
  if constexpr (AutodiffBackend<B>) {
    if (context.recompute) {
      auto again = [layer, offsets, before = context](const Tensor<B, 2>& rows) {
        return layer(rows, offsets, Context(before));
      };
      return keep_inputs(layer(x, offsets, context), std::move(again), x);
    }
  }
  return layer(x, offsets, context);
}
/// The same for layers that read a memory: layer(x, offsets, memory, context).
template <class Layer, Backend B>
Tensor<B, 2> run_layer(const Layer& layer, const Tensor<B, 2>& x, const Offsets& offsets, const Sequences<B>& memory,
                       const Context& context) {
  if constexpr (AutodiffBackend<B>) {
    if (context.recompute) {
      auto again = [layer, offsets, of_memory = memory.offsets, before = context](const Tensor<B, 2>& rows,
                                                                                  const Tensor<B, 2>& memory_rows) {
        return layer(rows, offsets, Sequences<B>(memory_rows, of_memory), Context(before));
      };
      return keep_inputs(layer(x, offsets, memory, context), std::move(again), x, memory.rows);
    }
  }
  return layer(x, offsets, memory, context);
}

MOTIONLANG_NAMESPACE_END
