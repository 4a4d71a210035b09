// SPDX-License-Identifier: MIT
// Two members by one name: they would share a place in a file, and the moments of the optimiser.
// expect: lists two members by the same name
#include <motionlang/backend/reference.hpp>
#include <motionlang/tensor/module.hpp>

namespace ml = motionlang;
using B = ml::ReferenceBackend<float>;

struct Model {
  ml::Tensor<B, 1> weight, bias;
#ifdef MISTAKE
  static constexpr auto fields() { return ml::fields("weight", &Model::weight, "weight", &Model::bias); }
#else
  static constexpr auto fields() { return ml::fields("weight", &Model::weight, "bias", &Model::bias); }
#endif
};

ml::Index numbers = ml::parameter_count(Model{});
