// The Eigen backend, bare and with a tape.
#include <motionlang/backend/eigen.hpp>

#include "autodiff_laws.hpp"
#include "backend_laws.hpp"

namespace ml = motionlang;

TEST_CASE_TEMPLATE("laws of the Eigen backend", B, ml::EigenBackend<float>, ml::EigenBackend<double>,
                   ml::Autodiff<ml::EigenBackend<float>>, ml::Autodiff<ml::EigenBackend<double>>) {
  laws::backend_laws<B>();
}

TEST_CASE_TEMPLATE("laws of derivatives over the Eigen backend", B, ml::EigenBackend<float>, ml::EigenBackend<double>) {
  laws::autodiff_laws<ml::Autodiff<B>>();
}
