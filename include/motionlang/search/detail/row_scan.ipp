// SPDX-License-Identifier: MIT
// Bodies of row_scan.hpp: the split of the work over threads, and the choice of vectors to compare exactly.
#pragma once

#include <algorithm>  // max_element
#include <cmath>      // sqrt
#include <cstring>    // memcpy
#include <limits>     // infinity

#include <motionlang/backend/kernel_ops.ipp>
#include <motionlang/core/parallel.hpp>
#include <motionlang/search/detail/row_scan.hpp>
#include <motionlang/search/detail/scan_kernels.hpp>
#include <motionlang/search/unit_rows.hpp>

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// The nearest rows so far for a group of queries, found by one thread.
template <class S>
class Candidates {
 public:
  Candidates(const RowScan<S>& scan, std::span<const S> queries, Index k, double error, std::span<const S> least)
      : scan_(scan),
        queries_(queries),
        error_(error),
        best_(queries.size() / static_cast<std::size_t>(scan.width), NearestK(k)),
        least_(least.begin(), least.end()) {
    least_.resize(best_.size(), -std::numeric_limits<S>::infinity());
    for (const S wanted : least_) limits_.push_back(static_cast<S>(wanted - error_));
  }

  /// A fast score that is not above the limit of its query does not need an exact one.
  S limit(Index query) const { return limits_[static_cast<std::size_t>(query)]; }
  /// score  the fast one
  void compare(Index query, Index row, S score) {
    const auto q = static_cast<std::size_t>(query);
    const S exact =
        exact_cosine(queries_.data() + query * scan_.width, scan_.rows.data() + row * scan_.width, scan_.width);
    if (!scan_.codes.empty() && !(exact <= score + error_))
      raise<io_error>(403, scan_.name, ": damaged: a cosine of ", exact, " above the bound ", score,
                      " of its code, at vector ", row, " of ", scan_.count);
    best_[q].offer({row, exact});
    limits_[q] = static_cast<S>(std::max(best_[q].least(), least_[q]) - error_);
  }
  void merge(const Candidates& other) {
    for (std::size_t q = 0; q < best_.size(); ++q) {
      for (const Neighbour& n : other.best_[q].unordered()) best_[q].offer(n);
    }
  }
  std::vector<Neighbour> take(Index query) { return best_[static_cast<std::size_t>(query)].take(); }

 private:
  const RowScan<S>& scan_;
  std::span<const S> queries_;
  double error_;
  std::vector<NearestK> best_;
  std::vector<S> least_, limits_;
};

/// Few queries: the gallery is read once, and each row is compared with all of them.
template <class S>
void scan_with_few(const RowScan<S>& scan, const ScanKernels<S>& kernel, std::span<const S> queries, Index first,
                   Index last, Candidates<S>& candidates) {
  constexpr Index block = 128;
  S scores[block];
  const Index width = scan.width, count = std::ssize(queries) / width;
  for (Index top = first; top < last; top += block) {
    const Index rows = std::min(block, last - top);
    for (Index q = 0; q < count; ++q) {
      if (!scan.codes.empty())
        kernel.dot_code_rows(scan.codes.data() + top * width, scan.bounds.data() + 2 * top, rows, width,
                             queries.data() + q * width, scores);
      else if (scan.halves.empty())
        kernel.dot_rows(scan.rows.data() + top * width, rows, width, queries.data() + q * width, scores);
      else
        kernel.dot_half_rows(scan.halves.data() + top * width, rows, width, queries.data() + q * width, scores);
      for (Index r = -1; (r = kernel.first_above(scores, r + 1, rows, candidates.limit(q))) < rows;)
        candidates.compare(q, top + r, scores[r]);
    }
  }
}

/// Sizes of a block of scores: rows of the gallery with panels of queries.
template <class S>
struct ScoreBlock {
  Index rows, panels, panel_width, product_scratch;

  explicit ScoreBlock(const Panels<S>& queries) {
    if (queries.kernels != nullptr) {  // one panel at a time: its scores stay in the first-level cache
      const Kernels<S>& kernel = *queries.kernels;
      rows = rows_of(kernel), panels = 1, panel_width = kernel.panel_width;
      product_scratch = kernel.gemm_scratch(queries.k);
    } else {  // all of them: every product puts the rows into another order first
      rows = 64, panels = parts(queries.n, bf16_columns), panel_width = bf16_columns;
      product_scratch = current_bf16_kernels()->gemm_scratch(queries.k);
    }
  }
  /// Whole tiles, few enough to stay in the second-level cache beside a panel.
  static Index rows_of(const Kernels<S>& kernel) { return 8 * kernel.tile_rows; }
  Index columns() const { return panels * panel_width; }
  /// The distance of rows. Few rows with a distance of a power of two fit into a cache.
  Index pitch() const { return panels == 1 ? panel_width : columns() + 16; }
  static Index gallery_pitch(Index width) { return (width + 15) / 16 * 16 + 16; }
  /// The number of values that scan_with_panels needs.
  Index scratch(Index width) const {
    return product_scratch + rows * pitch() + columns() + rows * gallery_pitch(width);
  }
};

/// Many queries, in panels: a matrix product whose scores are checked while they are in a cache.
template <class S>
void scan_with_panels(const RowScan<S>& scan, const Panels<S>& queries, Index first, Index last, S* scratch,
                      Candidates<S>& candidates) {
  const ScanKernels<S>& scanner = scan_kernels(kernels<S>());
  const ScoreBlock<S> block(queries);
  const Index width = scan.width, pitch = block.gallery_pitch(width), w = block.panel_width;
  S *scores = scratch + block.product_scratch, *maxima = scores + block.rows * block.pitch(),
    *gallery = maxima + block.columns();
  for (Index top = first; top < last; top += block.rows) {
    const Index rows = std::min(block.rows, last - top);
    for (Index r = 0; r < rows; ++r) {
      if (!scan.codes.empty())
        scanner.widen_codes(scan.codes.data() + (top + r) * width, width, gallery + r * pitch);
      else if (scan.halves.empty())
        std::memcpy(gallery + r * pitch, scan.rows.data() + (top + r) * width,
                    static_cast<std::size_t>(width) * sizeof(S));
      else
        scanner.widen_row(scan.halves.data() + (top + r) * width, width, gallery + r * pitch);
    }
    Gemm<S> product{
        .m = rows, .n = block.columns(), .k = width, .a = gallery, .lda = pitch, .c = scores, .ldc = block.pitch()};
    for (Index j = 0; j * w < queries.n; j += block.panels) {
      if (queries.kernels != nullptr) {
        product.panels = queries.data() + j * w * width;
        queries.kernels->gemm_block(product, 0, rows, 0, 1, scratch);
      } else {
        current_bf16_kernels()->gemm_block(product, queries.bf16(), 0, rows, 0, block.panels, scratch);
      }
      if (!scan.codes.empty())
        scanner.bound_rows(scores, scan.bounds.data() + 2 * top, rows, block.pitch(), block.columns());
      scanner.column_maxima(scores, rows, block.pitch(), block.columns(), maxima);
      for (Index c = 0; c < std::min(block.columns(), queries.n - j * w); ++c) {
        const Index query = j * w + c;
        if (!(maxima[c] > candidates.limit(query))) continue;
        for (Index r = 0; r < rows; ++r) {
          const S score = scores[r * block.pitch() + c];
          if (score > candidates.limit(query)) candidates.compare(query, top + r, score);
        }
      }
    }
  }
}

/// Queries in the order that the kernels want: for halves those of scan_with_few, for codes all.
template <class S>
std::vector<S> ordered_queries(const RowScan<S>& scan, std::span<const S> queries) {
  std::vector<S> out(queries.begin(), queries.end());
  if (scan.halves.empty() && scan.codes.empty()) return out;
  const auto& kernel = scan_kernels(kernels<S>());
  for (Index q = 0; q < std::ssize(queries); q += scan.width)
    (scan.codes.empty() ? kernel.split_pairs : kernel.split_quads)(queries.data() + q, scan.width, out.data() + q);
  return out;
}

/// Largest |q - bfloat16(q)|.
template <class S>
double rounding_of(std::span<const S> queries, Index width) {
  std::vector<std::uint16_t> halves(queries.size());
  return RowScan<S>::to_halves(queries, width, halves.data());
}

template <std::same_as<float> S>
std::vector<std::vector<Neighbour>> RowScan<S>::nearest(std::span<const S> queries, Index k,
                                                        std::span<const S> least) const {
  constexpr Index group = 1024, few = 8;  // queries: a group that shares a cache, and a number too small for a product
  const Kernels<S>& kernel = kernels<S>();
  const Index total = std::ssize(queries) / width, threads = thread_count();
  std::vector<std::vector<Neighbour>> out(static_cast<std::size_t>(total));
  if (k == 0) return out;
  const Index block = ScoreBlock<S>::rows_of(kernel), blocks = parts(count, block),
              tasks = std::min(blocks, std::max(8 * threads, parts(blocks, 64)));
  for (Index begin = 0; begin < total; begin += group) {
    const Index n = std::min(group, total - begin);
    const auto mine = queries.subspan(static_cast<std::size_t>(begin * width), static_cast<std::size_t>(n * width));
    const bool product = n > few, rounded = product && (!halves.empty() || !codes.empty());
    // Errors of float sums, and 1 % for smaller effects: lengths of 1.001, the rounding of the exact score and of the
    // limit.
    // A rounded row is longer than its row by at most half a unit of every code.
    const double longest = codes.empty() ? 1 : 1 + std::sqrt(static_cast<double>(width)) / 254;
    const double error = 1.01 * longest *
                         (static_cast<double>(width + (codes.empty() ? 2 : 4)) * 0x1p-24 + half_error +
                          (rounded ? rounding_of(mine, width) : 0));
    const auto limits =
        least.empty() ? least : least.subspan(static_cast<std::size_t>(begin), static_cast<std::size_t>(n));
    std::vector<Candidates<S>> seen(static_cast<std::size_t>(threads), Candidates<S>(*this, mine, k, error, limits));
    const auto for_rows = [&](auto f) {
      parallel_for(tasks, [&](Index i) {
        f(blocks * i / tasks * block, std::min(count, blocks * (i + 1) / tasks * block),
          seen[static_cast<std::size_t>(thread_number())]);
      });
    };
    const auto ordered = product && codes.empty() ? std::vector<S>() : ordered_queries<S>(*this, mine);
    if (product) {
      if (rounded) use_bf16_products();
      const auto panels = pack_panels<S>(codes.empty() ? mine.data() : ordered.data(), width, n, 1, width,
                                         rounded ? Precision::bf16 : Precision::fp32);
      const Scratch<S> scratch(ScoreBlock<S>(panels).scratch(width));
      for_rows([&](Index first, Index last, Candidates<S>& c) {
        scan_with_panels<S>(*this, panels, first, last, scratch.mine(), c);
      });
    } else {
      for_rows([&](Index first, Index last, Candidates<S>& c) {
        scan_with_few<S>(*this, scan_kernels(kernel), ordered, first, last, c);
      });
    }
    for (std::size_t t = 1; t < seen.size(); ++t) seen[0].merge(seen[t]);
    for (Index q = 0; q < n; ++q) out[static_cast<std::size_t>(begin + q)] = seen[0].take(q);
  }
  return out;
}

template <std::same_as<float> S>
double RowScan<S>::to_halves(std::span<const S> rows, Index width, std::uint16_t* halves) {
  constexpr Index at_once = 256;
  const Index count = std::ssize(rows) / width;
  std::vector<double> worst(static_cast<std::size_t>(parts(count, at_once)));
  parallel_for(std::ssize(worst), [&](Index part) {
    for (Index r = part * at_once; r < std::min(count, (part + 1) * at_once); ++r) {
      double square = 0;
      for (Index i = r * width; i < (r + 1) * width; ++i) {
        halves[i] = float_to_bfloat16(rows[static_cast<std::size_t>(i)]);
        const double d =
            static_cast<double>(rows[static_cast<std::size_t>(i)]) - static_cast<double>(bfloat16_to_float(halves[i]));
        square += d * d;
      }
      auto& w = worst[static_cast<std::size_t>(part)];
      w = std::max(w, std::sqrt(square));
    }
  });
  return worst.empty() ? 0 : *std::max_element(worst.begin(), worst.end());
}

template <std::same_as<float> S>
void RowScan<S>::to_codes(std::span<const S> rows, Index width, std::int8_t* codes, S* bounds) {
  constexpr Index at_once = 256;
  const Index count = std::ssize(rows) / width;
  parallel_for(parts(count, at_once), [&](Index part) {
    for (Index r = part * at_once; r < std::min(count, (part + 1) * at_once); ++r) {
      const S* x = rows.data() + r * width;
      S largest = 0;
      for (Index i = 0; i < width; ++i) largest = std::max(largest, std::abs(x[i]));
      const S scale = largest > 0 ? largest / 127 : 1;
      double square = 0;
      for (Index i = 0; i < width; ++i) {
        const auto code = static_cast<std::int8_t>(std::lround(std::clamp<S>(x[i] / scale, -127, 127)));
        codes[r * width + i] = code;
        const double d = static_cast<double>(x[i]) - static_cast<double>(scale) * static_cast<double>(code);
        square += d * d;
      }
      bounds[2 * r] = scale, bounds[2 * r + 1] = static_cast<S>(std::sqrt(square) * 1.0001);  // and its own rounding
    }
  });
}

template <std::same_as<float> S>
typename RowScan<S>::DotFunction RowScan<S>::dot_function() {
  return scan_kernels(kernels<S>()).dot_rows;
}

}  // namespace detail
MOTIONLANG_NAMESPACE_END
