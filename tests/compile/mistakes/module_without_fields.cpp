// SPDX-License-Identifier: MIT
// A model that does not list its parameters.
// expect: parameter_count
// expect: M::fields\(\)
#include <motionlang/backend/reference.hpp>
#include <motionlang/nn/linear.hpp>

namespace ml = motionlang;

template <ml::Backend B>
struct Model {
  ml::Linear<B> in, out;
#ifndef MISTAKE
  static constexpr auto fields() { return ml::fields("in", &Model::in, "out", &Model::out); }
#endif
};

ml::Index numbers = ml::parameter_count(Model<ml::ReferenceBackend<float>>{});
