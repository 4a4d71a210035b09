// Everything that calculates like a number.
#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>
#include <motionlang/backend/xtensor.hpp>

#include "scalar_laws.hpp"

namespace ml = motionlang;

TEST_CASE_TEMPLATE("laws of scalars: numbers, duals, registers", S, float, double, ml::Dual<float>, ml::Dual<double>,
                   ml::Lane<float>, ml::Lane<double>, ml::Lane<float, 16>, ml::Lane<float, 64>) {
  laws::scalar_laws<S>();
}

TEST_CASE_TEMPLATE("laws of scalars: tensors", B, ml::ReferenceBackend<float>, ml::ReferenceBackend<double>,
                   ml::EigenBackend<float>, ml::EigenBackend<double>, ml::XtensorBackend<float>,
                   ml::XtensorBackend<double>, ml::Autodiff<ml::ReferenceBackend<double>>) {
  laws::scalar_laws<ml::Tensor<B, 1>>();
}
