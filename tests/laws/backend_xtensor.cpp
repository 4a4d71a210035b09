// The xtensor backend, bare and with a tape.
#include <motionlang/backend/xtensor.hpp>

#include "autodiff_laws.hpp"
#include "backend_laws.hpp"

namespace ml = motionlang;

TEST_CASE_TEMPLATE("laws of the xtensor backend", B, ml::XtensorBackend<float>, ml::XtensorBackend<double>,
                   ml::Autodiff<ml::XtensorBackend<float>>, ml::Autodiff<ml::XtensorBackend<double>>) {
  laws::backend_laws<B>();
}

TEST_CASE_TEMPLATE("laws of derivatives over the xtensor backend", B, ml::XtensorBackend<float>,
                   ml::XtensorBackend<double>) {
  laws::autodiff_laws<ml::Autodiff<B>>();
}
