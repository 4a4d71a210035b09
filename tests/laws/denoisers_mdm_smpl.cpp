// MDM-SMPL.
#include "denoiser_laws.hpp"

namespace ml = motionlang;
using namespace laws;
using namespace modules;

TEST_CASE_TEMPLATE("laws of denoisers: MDM-SMPL", B, ml::ReferenceBackend<double>, ml::EigenBackend<float>,
                   ml::XtensorBackend<float>) {
  denoiser_laws<SmallMdmSmpl, B>();
}

TEST_CASE("laws of modules and of the tape: MDM-SMPL") {
  module_laws<SmallMdmSmpl>();
  tape_law<SmallMdmSmpl, ml::EigenBackend<double>>();
}
