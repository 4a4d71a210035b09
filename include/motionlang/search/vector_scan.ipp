// SPDX-License-Identifier: MIT
// Bodies of vector_scan.hpp.
#pragma once

#include <motionlang/core/large_memory.hpp>
#include <motionlang/search/unit_rows.hpp>
#include <motionlang/search/vector_scan.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY VectorScan::VectorScan(std::span<const float> rows, Index width, std::shared_ptr<const void> owner,
                                       ScanStorage storage)
    : owner_(std::move(owner)) {
  require_unit_rows("VectorScan", rows, width);
  scan_ = {rows, {}, static_cast<Index>(rows.size()) / width, width};
  if (storage == ScanStorage::float32) return;
  const auto halves = large_table<std::uint16_t>(rows.size());
  scan_.half_error = detail::RowScan<float>::to_halves(rows, width, halves.get());
  scan_.halves = {halves.get(), rows.size()};
  halves_ = halves;
}

MOTIONLANG_BODY std::vector<std::vector<Neighbour>> VectorScan::search(std::span<const float> queries, Index k) const {
  if (k < 0) raise<config_error>(101, "VectorScan: the ", k, " nearest");
  detail::whole_rows("VectorScan: queries", queries.size(), width());
  return scan_.nearest(unit_rows(queries, width()), std::min(k, count()));
}

MOTIONLANG_NAMESPACE_END
