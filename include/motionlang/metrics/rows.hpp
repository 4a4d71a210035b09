// SPDX-License-Identifier: MIT
/// Vectors of one width in rows: the latents, embeddings and activations that metrics compare. Also their distances,
/// computed in double for any scalar.
///
///     const Rows texts(text_latents.span(), 256), motions(motion_latents.span(), 256);
///     const std::vector<double> similarity = cosine_similarities(texts, motions);      // (texts, motions)
#pragma once

#include <algorithm>  // min, max
#include <cmath>      // sqrt
#include <span>       // values
#include <string>     // sizes in messages
#include <vector>     // tables

#include <motionlang/core/concepts.hpp>
#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A view of (rows, width) values.
template <Scalar S>
class Rows {
 public:
  /// Throws shape_error 205 unless the values are whole rows.
  Rows(std::span<const S> values, Index width) : values_(values), width_(width) {
    if (width < 1 || std::ssize(values) % width != 0)
      raise<shape_error>(205, "Rows: ", values.size(), " values are not rows of ", width);
  }
  Rows(const std::vector<S>& values, Index width) : Rows(std::span<const S>(values), width) {}

  Index size() const { return std::ssize(values_) / width_; }
  Index width() const { return width_; }
  std::span<const S> operator[](Index row) const {
    return values_.subspan(static_cast<std::size_t>(row * width_), static_cast<std::size_t>(width_));
  }
  std::span<const S> values() const { return values_; }

  /// Rows first ... first + count - 1. Throws shape_error 203 if there are fewer.
  Rows slice(Index first, Index count) const {
    if (first < 0 || count < 0 || first + count > size())
      raise<shape_error>(203, "Rows: ", first, " to ", first + count, " of ", size(), " rows");
    return {values_.subspan(static_cast<std::size_t>(first * width_), static_cast<std::size_t>(count * width_)),
            width_};
  }

 private:
  std::span<const S> values_;
  Index width_;
};

/// Rows at the given positions, in this order. Throws shape_error 203 for a position that does not exist.
template <Scalar S>
std::vector<S> rows_at(const Rows<S>& rows, std::span<const Index> positions) {
  std::vector<S> out;
  out.reserve(positions.size() * static_cast<std::size_t>(rows.width()));
  for (const Index p : positions) {
    const auto row = rows.slice(p, 1).values();
    out.insert(out.end(), row.begin(), row.end());
  }
  return out;
}

namespace detail {

/// Throws shape_error 204 unless both have the same width.
template <Scalar S, Scalar T>
void require_same_width(const char* function, const Rows<S>& x, const Rows<T>& y) {
  if (x.width() != y.width())
    raise<shape_error>(204, function, ": rows of ", x.width(), " numbers against rows of ", y.width());
}
/// Throws shape_error 204 unless both counts are equal.
inline void require_same_count(const char* function, Index x, Index y) {
  if (x != y) raise<shape_error>(204, function, ": ", x, " against ", y);
}
/// Throws shape_error 205 unless the rows are a square table.
template <Scalar S>
void require_square(const char* function, const Rows<S>& table) {
  if (table.size() != table.width())
    raise<shape_error>(205, function, ": a table of ", table.size(), " rows and ", table.width(), " columns");
}

/// Sums run from the first value to the last, so equal rows give equal results bit by bit.
template <Scalar S, Scalar T>
double dot_product(std::span<const S> x, std::span<const T> y) {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += static_cast<double>(x[i]) * static_cast<double>(y[i]);
  return sum;
}
template <Scalar S, Scalar T>
double euclidean_distance(std::span<const S> x, std::span<const T> y) {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double d = static_cast<double>(x[i]) - static_cast<double>(y[i]);
    sum += d * d;
  }
  return std::sqrt(sum);
}
/// Calls on_product(i, j, x_i . y_j) for all pairs. The sums are those of `dot_product`, sixteen side by side.
template <Scalar S, Scalar T, class F>
void each_dot_product(const Rows<S>& x, const Rows<T>& y, F on_product) {
  constexpr Index block = 16;
  const Index width = y.width();
  std::vector<double> columns(static_cast<std::size_t>(width * block));  // (width, block) of y, transposed
  for (Index first = 0; first < y.size(); first += block) {
    const Index count = std::min(block, y.size() - first);
    for (Index j = 0; j < count; ++j) {
      const auto row = y[first + j];
      for (Index k = 0; k < width; ++k) {
        columns[static_cast<std::size_t>(k * block + j)] = static_cast<double>(row[static_cast<std::size_t>(k)]);
      }
    }
    for (Index i = 0; i < x.size(); ++i) {
      double sums[block] = {};
      const double* column = columns.data();
      for (const S value : x[i]) {
        const auto v = static_cast<double>(value);
        for (Index j = 0; j < block; ++j) sums[j] += v * column[j];
        column += block;
      }
      for (Index j = 0; j < count; ++j) on_product(i, first + j, sums[j]);
    }
  }
}
template <Scalar S>
std::vector<double> lengths_of_rows(const Rows<S>& rows, double least) {
  std::vector<double> out;
  for (Index i = 0; i < rows.size(); ++i) out.push_back(std::max(std::sqrt(dot_product(rows[i], rows[i])), least));
  return out;
}

}  // namespace detail

/// |x_i - y_j|, (x, y). The evaluator of Guo et al. expands the square, which loses digits for close rows. Throws
/// shape_error 204.
template <Scalar S, Scalar T>
std::vector<double> distances(const Rows<S>& x, const Rows<T>& y) {
  detail::require_same_width("distances", x, y);
  std::vector<double> out;
  out.reserve(static_cast<std::size_t>(x.size() * y.size()));
  for (Index i = 0; i < x.size(); ++i) {
    for (Index j = 0; j < y.size(); ++j) out.push_back(detail::euclidean_distance(x[i], y[j]));
  }
  return out;
}
/// |x_i - y_i|. Throws shape_error 204.
template <Scalar S, Scalar T>
std::vector<double> paired_distances(const Rows<S>& x, const Rows<T>& y) {
  detail::require_same_width("paired_distances", x, y);
  detail::require_same_count("paired_distances", x.size(), y.size());
  std::vector<double> out;
  for (Index i = 0; i < x.size(); ++i) out.push_back(detail::euclidean_distance(x[i], y[i]));
  return out;
}

///     cos_ij = x_i . y_j / (max(|x_i|, eps) max(|y_j|, eps)),   (x, y)
/// Source  TMR src/model/tmr.py get_sim_matrix (eps 1e-12); SINC's score has eps 1e-8. Throws shape_error 204.
template <Scalar S, Scalar T>
std::vector<double> cosine_similarities(const Rows<S>& x, const Rows<T>& y, double eps = 1e-12) {
  detail::require_same_width("cosine_similarities", x, y);
  const auto x_length = detail::lengths_of_rows(x, eps), y_length = detail::lengths_of_rows(y, eps);
  std::vector<double> out(x_length.size() * y_length.size());
  detail::each_dot_product(x, y, [&](Index i, Index j, double product) {
    out[static_cast<std::size_t>(i * y.size() + j)] =
        product / (x_length[static_cast<std::size_t>(i)] * y_length[static_cast<std::size_t>(j)]);
  });
  return out;
}

/// A cosine as a score from 0 to 1, as TMR and STMC print it; unrelated texts and motions have about 0.5.
inline double similarity_score(double cosine) { return (cosine + 1) / 2; }

MOTIONLANG_NAMESPACE_END
