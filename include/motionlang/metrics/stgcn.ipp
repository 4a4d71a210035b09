// SPDX-License-Identifier: MIT
// Bodies of stgcn.hpp.
#pragma once

#include <motionlang/metrics/stgcn.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY std::vector<double> stgcn_adjacency(std::span<const int> parents, Index centre) {
  const auto n = std::ssize(parents);
  if (centre < 0 || centre >= n) raise<config_error>(101, "stgcn_adjacency: centre ", centre, " of ", n, " joints");
  auto parent = [&](Index j) { return static_cast<Index>(parents[static_cast<std::size_t>(j)]); };
  auto linked = [&](Index i, Index j) { return i == j || parent(i) == j || parent(j) == i; };
  auto hops = [&](Index j) { return j == centre ? 0 : linked(j, centre) ? 1 : 2; };
  std::vector<double> out(static_cast<std::size_t>(3 * n * n));
  for (Index j = 0; j < n; ++j) {
    Index links = 0;
    for (Index i = 0; i < n; ++i) links += linked(i, j) ? 1 : 0;
    for (Index i = 0; i < n; ++i) {
      const Index part = i == j ? 0 : hops(i) < hops(j) ? 2 : 1;
      if (linked(i, j)) out[static_cast<std::size_t>((part * n + i) * n + j)] = 1 / static_cast<double>(links);
    }
  }
  return out;
}

MOTIONLANG_BODY std::vector<int> StGcnConfig::without_root(std::span<const int> parents) {
  std::vector<int> out;
  for (std::size_t j = 1; j < parents.size(); ++j) out.push_back(parents[j] > 0 ? parents[j] - 1 : -1);
  return out;
}

MOTIONLANG_NAMESPACE_END
