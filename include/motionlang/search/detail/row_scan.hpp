// SPDX-License-Identifier: MIT
/// The scan of VectorScan, see vector_scan.hpp.
#pragma once

#include <cstdint>  // bfloat16
#include <string>   // names

#include <motionlang/search/nearest.hpp>

MOTIONLANG_NAMESPACE_BEGIN
namespace detail {

/// The scan itself. It is a template, so that motionlang::instantiated can compile it once.
template <std::same_as<float> S>
struct RowScan {
  std::span<const S> rows;                // (count, width)
  std::span<const std::uint16_t> halves;  // the same in bfloat16, or empty
  Index count = 0, width = 0;
  double half_error = 0;                 // largest |x - bfloat16(x)|
  std::span<const std::int8_t> codes{};  // the same in eight bits (to_codes), or empty
  std::span<const S> bounds{};           // (count, 2) of the codes
  std::string name{};                    // of the codes, for messages

  /// queries  (n, width) of length 1
  /// least    for each query a score that must be reached, or none
  /// Throws   io_error 403 with the row if an exact score exceeds the bound of its code
  std::vector<std::vector<Neighbour>> nearest(std::span<const S> queries, Index k, std::span<const S> least = {}) const;
  /// Rounds rows to bfloat16. Returns the largest |x - bfloat16(x)|.
  static double to_halves(std::span<const S> rows, Index width, std::uint16_t* halves);
  /// Rounds each row x to codes c in -127 ... 127 and its bounds (s, e): e is at least |x - s c|, so the cosine with a
  /// query q is at most s <c, q> + e.
  static void to_codes(std::span<const S> rows, Index width, std::int8_t* codes, S* bounds);
  /// out[r] = <row r, query>, in float.
  using DotFunction = void (*)(const S* rows, Index count, Index width, const S* query, S* out);
  static DotFunction dot_function();
};

}  // namespace detail

MOTIONLANG_NAMESPACE_END

#ifdef MOTIONLANG_INSTANTIATED
extern template struct motionlang::detail::RowScan<float>;
#else
#include <motionlang/search/detail/row_scan.ipp>
#endif
