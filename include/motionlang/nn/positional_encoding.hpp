// SPDX-License-Identifier: MIT
/// Sinusoidal positions.
#pragma once

#include <cmath>  // sin, cos

#include <motionlang/core/buffer_pool.hpp>
#include <motionlang/core/parallel.hpp>
#include <motionlang/core/scalar_math.hpp>
#include <motionlang/tensor/ops.hpp>
#include <motionlang/tensor/sequences.hpp>

MOTIONLANG_NAMESPACE_BEGIN

///     pe[p, 2i] = sin(p w_i),   pe[p, 2i + 1] = cos(p w_i),   w_i = exp(-2i ln(10000) / width)
/// Source  Vaswani et al. (2017), section 3.5. Every intermediate is rounded to float, as in the published tables,
///         whose last digits depend on it. Sines are rounded from double, because the float functions of C
///         libraries differ in the last bit. Throws config_error 101 for an odd width.
template <Backend B>
Tensor<B, 2> sinusoidal_positions(Index rows, Index width) {
  if (width % 2 != 0) raise<config_error>(101, "sinusoidal_positions: odd width ", width);
  std::vector<float> frequencies(static_cast<std::size_t>(width / 2));
  const auto c = static_cast<float>(-std::log(10000.0) / static_cast<double>(width));
  for (std::size_t i = 0; i < frequencies.size(); ++i) frequencies[i] = torch_exp(static_cast<float>(2 * i) * c);
  using S = typename B::scalar;
  return Tensor<B, 2>::written({rows, width}, [&](S* table) {
    parallel_ranges(rows, 16 * width, [&](Index first, Index last) {
      S* at = table + first * width;
      for (Index p = first; p < last; ++p) {
        for (const float w : frequencies) {
          const float angle = static_cast<float>(p) * w;
          *at++ = static_cast<S>(static_cast<float>(std::sin(static_cast<double>(angle))));
          *at++ = static_cast<S>(static_cast<float>(std::cos(static_cast<double>(angle))));
        }
      }
    });
  });
}

/// The table of a model. It is computed from its size, so it is neither saved nor loaded.
template <Backend B>
class PositionTable {
 public:
  static constexpr bool is_option = true;  // computed, not saved
  PositionTable() = default;
  PositionTable(Index rows, Index width) : rows_(sinusoidal_positions<B>(rows, width)) {}
  template <Backend C>
  explicit PositionTable(const PositionTable<C>& other) : PositionTable(other.rows().size(0), other.rows().size(1)) {}

  const Tensor<B, 2>& rows() const { return rows_; }

 private:
  Tensor<B, 2> rows_;
};

/// Positions of a sequence that are skipped, as for padding: `rows` of them before row `before`.
struct PositionGap {
  Index before = 0, rows = 0;
};

namespace detail {

/// Throws shape_error 203.
template <Backend B>
void require_positions(std::string_view op, const Tensor<B, 2>& table, Index wanted) {
  if (wanted > table.size(0))
    raise<shape_error>(203, op, ": a sequence of ", wanted, " rows; the model has positions for ", table.size(0));
}

}  // namespace detail

/// Adds row i of the table to row i of each sequence. With `gaps`, one for each sequence, later rows take higher
/// positions. Throws shape_error 203 for a sequence longer than the table, and 204 for another number of gaps.
template <Backend B>
Sequences<B> add_positions(const Sequences<B>& x, const Tensor<B, 2>& table, std::span<const PositionGap> gaps = {}) {
  if (!gaps.empty() && static_cast<Index>(gaps.size()) != x.count()) {
    raise<shape_error>(204, "add_positions: ", gaps.size(), " gaps for ", x.count(), " sequences");
  }
  PoolVector<Index> rows;
  rows.reserve(static_cast<std::size_t>(x.offsets.rows()));
  for (Index s = 0; s < x.count(); ++s) {
    const PositionGap gap = gaps.empty() ? PositionGap{} : gaps[static_cast<std::size_t>(s)];
    const Index length = x.offsets.length(s);
    detail::require_positions("add_positions", table, length > gap.before ? length + gap.rows : length);
    for (Index i = 0; i < length; ++i) rows.push_back(i < gap.before ? i : i + gap.rows);
  }
  return x.with(gather(table, rows) + x.rows);
}

/// The relative time of each row in its sequence, (rows, 1): t / (length - 1). Differs from published code for a
/// sequence of one row: 0 instead of a division by 0.
template <Backend B>
Tensor<B, 2> relative_time(const Offsets& offsets) {
  std::vector<typename B::scalar> time;
  for (Index s = 0; s < offsets.count(); ++s) {
    const auto last = static_cast<double>(std::max<Index>(1, offsets.length(s) - 1));
    for (Index t = 0; t < offsets.length(s); ++t)
      time.push_back(static_cast<typename B::scalar>(static_cast<double>(t) / last));
  }
  return Tensor<B, 2>::from(time, {offsets.rows(), 1});
}

MOTIONLANG_NAMESPACE_END
