// SPDX-License-Identifier: MIT
// A part of a model that does not list its parameters: they would neither be saved nor trained.
// expect: lists a member whose type has no fields\(\)
#include <motionlang/backend/reference.hpp>
#include <motionlang/tensor/module.hpp>

namespace ml = motionlang;
using B = ml::ReferenceBackend<float>;

struct Part {
  ml::Tensor<B, 1> weight;
#ifndef MISTAKE
  static constexpr auto fields() { return ml::fields("weight", &Part::weight); }
#endif
};
struct Model {
  Part part;
  static constexpr auto fields() { return ml::fields("part", &Model::part); }
};

ml::Index numbers = ml::parameter_count(Model{});
