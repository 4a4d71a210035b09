// MotionDiffuse with linear and with standard attention.
#include "denoiser_laws.hpp"

namespace ml = motionlang;
using namespace laws;
using namespace modules;

TEST_CASE_TEMPLATE("laws of denoisers: MotionDiffuse", B, ml::ReferenceBackend<double>, ml::EigenBackend<float>,
                   ml::XtensorBackend<float>) {
  denoiser_laws<SmallMotionDiffuse<false>, B>();
  denoiser_laws<SmallMotionDiffuse<true>, B>();
}

TEST_CASE("laws of modules and of the tape: MotionDiffuse") {
  module_laws<SmallMotionDiffuse<false>>();
  tape_law<SmallMotionDiffuse<false>, ml::EigenBackend<double>>();
  module_laws<SmallMotionDiffuse<true>>();
  tape_law<SmallMotionDiffuse<true>, ml::EigenBackend<double>>();
}
