// SPDX-License-Identifier: MIT
/// Laws of Module:
///
///     names        are unique and the same at every visit, in the same order, on every backend
///     conversion   float to double on a tape and back keeps every number; what can be trained becomes a variable
///     values       a copy is a model of its own: changing it leaves the original as it was
#pragma once

#include <doctest/doctest.h>

#include <set>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/tensor/module.hpp>

#include "../support/tensors.hpp"

namespace laws {

namespace ml = motionlang;

template <ml::Module M>
std::vector<std::string> names(M& module) {
  std::vector<std::string> out;
  ml::visit(module, [&](const std::string& path, const auto&) { out.push_back(path); });
  return out;
}

/// Tensors of both modules are equal, one by one.
template <ml::Module M, ml::Module N>
bool same_numbers(const M& a, const N& b) {
  bool same = true;
  ml::zip(a, b, [&](const std::string&, const auto& x, const auto& y) {
    if constexpr (ml::is_tensor<std::remove_cvref_t<decltype(x)>>) same = same && tensors::same_bits(x, y);
  });
  return same;
}

/// `Small` makes a module over any backend.
template <class Small>
void module_laws() {
  using B = ml::EigenBackend<float>;
  using A = ml::Autodiff<ml::EigenBackend<double>>;
  auto model = Small::template make<B>(ml::Philox{.seed = 1});
  const auto paths = names(model);
  CHECK(std::set<std::string>(paths.begin(), paths.end()).size() == paths.size());
  CHECK(names(model) == paths);
  CHECK(names(std::as_const(model)) == paths);
  CHECK(ml::count_leaves(model) == std::ssize(paths));

  const auto taped = ml::convert<A>(model);
  CHECK(names(taped) == paths);
  CHECK(same_numbers(model, taped));
  CHECK(same_numbers(ml::convert<B>(taped), model));
  CHECK(same_numbers(ml::to_inner(taped), model));
  ml::visit_tensors(taped, [&](const std::string& path, const auto& t) {
    CHECK_MESSAGE((t.data().node != nullptr) == ml::is_trainable<decltype(model)>, path);
  });

  const auto original = ml::convert<B>(model);
  auto copy = model;
  ml::visit_tensors(copy, [](const std::string&, auto& t) { t = std::move(t) + 1.0; });
  CHECK_FALSE(same_numbers(copy, model));
  CHECK(same_numbers(model, original));
}

}  // namespace laws
