// A backend of a user's, that of the example. Not over Eigen in float: its exp of a packet and that of a single value
// differ in the last bit, so softmax by its definition depends on where a row lies, which the law of batches forbids.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/reference.hpp>

#include "../../examples/11_own_backend/counting_backend.hpp"
#include "backend_laws.hpp"

namespace ml = motionlang;

TEST_CASE_TEMPLATE("laws of an own backend", B, CountingBackend<ml::ReferenceBackend<float>>,
                   CountingBackend<ml::EigenBackend<double>>) {
  B::reset();
  laws::backend_laws<B>();
  CHECK(B::counts().size() > 15);  // it was this backend that calculated
}
