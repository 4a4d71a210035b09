// SPDX-License-Identifier: MIT
/// Parts of a batch whose samples a loss compares with all other samples, as contrastive losses do. Several processes
/// compute the parts.
///
///     1. Each part gives rows, such as the latents of its samples. All processes get the rows of all parts.
///     2. The loss of all rows, and its derivatives g by the rows, are computed in every process, with the same bits.
///     3. A part adds  sum(rows g)  to its own terms, with g as constants. Its gradient is that of the loss.
///
/// Source   Gao, Zhang, Han, Callan: "Scaling deep contrastive learning batch size under memory limited setup" (2021)
/// Differs  the parts keep their graphs between 1 and 3, and compute nothing twice
#pragma once

#include <algorithm>  // copy
#include <cstddef>    // sizes
#include <span>       // rows of all parts
#include <utility>    // move
#include <vector>     // rows

#include <motionlang/core/context.hpp>
#include <motionlang/loss/loss_terms.hpp>
#include <motionlang/train/batch_parts.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The rows of a part, and their place among the rows of the batch.
template <Backend B>
struct ComparedRows {
  Tensor<B, 2> rows{};  // empty if this part has none of them
  Index width = 0;
  Index first = 0, all = 0;  // rows before them, rows of the batch

  Index count() const { return rows.count() / width; }
};
template <Backend B>
struct ComparedPart {
  LossTerms<B> terms{};                     // those that compare nothing; all parts have the same
  std::vector<ComparedRows<B>> compared{};  // all parts have equally many
};

/// The rows of a part in their places, one list after another, with zeros for other parts: the sum over the parts has
/// the rows of all.
template <Backend B>
std::vector<typename B::scalar> rows_in_place(const ComparedPart<B>& part);
/// The sum in all processes, as tensors. `like`: any part. Throws shape_error 205 for a list of another length.
template <AutodiffBackend A>
std::vector<Tensor<A, 2>> compared_variables(std::span<const typename A::scalar> sum, const ComparedPart<A>& like);
/// Step 3: a number whose gradient by the parameters is that of the loss behind `gradients`, as far as it depends on
/// them through the rows of this part.
template <AutodiffBackend A>
Tensor<A, 0> through_rows(const ComparedPart<A>& part, const std::vector<Tensor<A, 2>>& rows,
                          const Gradients<A>& gradients);

/// The loss of a task for a batch in one part.
template <class Task>
auto loss_of_one_part(Task& task, const Philox& rng, Index step, const Context& context) {
  auto part = task.compared_part(rng, step, BatchPart{0, task.samples(step)}, context);
  auto out = std::move(part.terms);
  std::vector<Tensor<typename Task::A, 2>> rows;
  for (auto& r : part.compared) rows.push_back(std::move(r.rows));
  out.append(task.compared_loss(rng, step, rows));
  return out;
}

template <Backend B>
std::vector<typename B::scalar> rows_in_place(const ComparedPart<B>& part) {
  std::vector<typename B::scalar> out;
  for (const auto& r : part.compared) {
    const Index before = std::ssize(out);
    out.resize(out.size() + static_cast<std::size_t>(r.all * r.width));
    if (r.count() == 0) continue;
    const auto values = r.rows.span();
    std::copy(values.begin(), values.end(), out.begin() + before + r.first * r.width);
  }
  return out;
}

template <AutodiffBackend A>
std::vector<Tensor<A, 2>> compared_variables(std::span<const typename A::scalar> sum, const ComparedPart<A>& like) {
  std::size_t wanted = 0;
  for (const auto& r : like.compared) wanted += static_cast<std::size_t>(r.all * r.width);
  if (sum.size() != wanted)
    raise<shape_error>(205, "compared_variables: ", sum.size(), " numbers, the rows of a batch are ", wanted);
  std::vector<Tensor<A, 2>> out;
  for (const auto& r : like.compared) {
    const auto count = static_cast<std::size_t>(r.all * r.width);
    out.push_back(variable<A>(Tensor<typename A::inner, 2>::from(sum.first(count), {r.all, r.width})));
    sum = sum.subspan(count);
  }
  return out;
}

template <AutodiffBackend A>
Tensor<A, 0> through_rows(const ComparedPart<A>& part, const std::vector<Tensor<A, 2>>& rows,
                          const Gradients<A>& gradients) {
  Tensor<A, 0> out(0.0);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto& r = part.compared[k];
    if (r.count() == 0) continue;
    const auto g = gradients[rows[k]];
    const auto own =
        g.span().subspan(static_cast<std::size_t>(r.first * r.width), static_cast<std::size_t>(r.count() * r.width));
    out = out + sum(r.rows * Tensor<A, 2>::from(own, {r.count(), r.width}));
  }
  return out;
}

MOTIONLANG_NAMESPACE_END
