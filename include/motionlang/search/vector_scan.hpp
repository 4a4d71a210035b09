// SPDX-License-Identifier: MIT
/// Exact search: every vector of the gallery is compared with every query.
///
///     const VectorScan gallery(rows, 256);                  // rows of length 1, not copied
///     for (const Neighbour& n : gallery.search(query, 10)[0]) use(n);
///
/// Many queries are a matrix product whose scores are used while they are in a cache. For few queries the gallery is
/// read once. These fast scores (float sums in the kernel's order, rows or both sides rounded to bfloat16) only exclude
/// vectors that cannot be among the k nearest. Vectors within the error bound of the k-th are compared by exact_cosine.
/// So an answer does not depend on the processor, the number of threads, the other queries or the storage.
///
///     |fast - exact| <= (width + 2) 2^-24 |q| |x|  + |q| max_x |x - bfloat16(x)| + |x| max_q |q - bfloat16(q)|
///
/// Source    Higham, Accuracy and Stability of Numerical Algorithms, section 3.1: error of an inner product in any
///           order
#pragma once

#include <memory>  // owner of the rows

#include <motionlang/search/detail/row_scan.hpp>
#include <motionlang/search/unit_rows.hpp>

MOTIONLANG_NAMESPACE_BEGIN

enum class ScanStorage {
  float32,  // the rows themselves
  // Scans a copy of half the size, with products in bfloat16 for many queries; reads the rows only for the best ones.
  bfloat16,
};

class VectorScan : public VectorSearch {
 public:
  /// rows   (count, width) of length 1
  /// owner  keeps them alive; without an owner they must outlive the object
  /// Throws shape_error 205, config_error 101, numeric_error 302 (require_unit_rows)
  VectorScan(std::span<const float> rows, Index width, std::shared_ptr<const void> owner = {},
             ScanStorage storage = ScanStorage::float32);

  Index count() const override { return scan_.count; }
  Index width() const override { return scan_.width; }
  std::vector<std::vector<Neighbour>> search(std::span<const float> queries, Index k) const override;

 private:
  detail::RowScan<float> scan_;
  std::shared_ptr<const void> owner_, halves_;
};

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/search/vector_scan.ipp>
#endif
