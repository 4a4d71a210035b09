// The reference backend, bare and with a tape.
#include <motionlang/backend/reference.hpp>

#include "autodiff_laws.hpp"
#include "backend_laws.hpp"

namespace ml = motionlang;

TEST_CASE_TEMPLATE("laws of the reference backend", B, ml::ReferenceBackend<float>, ml::ReferenceBackend<double>,
                   ml::Autodiff<ml::ReferenceBackend<float>>, ml::Autodiff<ml::ReferenceBackend<double>>) {
  laws::backend_laws<B>();
}

TEST_CASE_TEMPLATE("laws of derivatives over the reference backend", B, ml::ReferenceBackend<float>,
                   ml::ReferenceBackend<double>) {
  laws::autodiff_laws<ml::Autodiff<B>>();
}
