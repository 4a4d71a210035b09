// MDM in its architectures.
#include "denoiser_laws.hpp"

namespace ml = motionlang;
using namespace laws;
using namespace modules;

TEST_CASE_TEMPLATE("laws of denoisers: MDM", B, ml::ReferenceBackend<double>, ml::EigenBackend<float>,
                   ml::XtensorBackend<float>) {
  denoiser_laws<SmallMdmEncoder, B>();
  denoiser_laws<SmallMdmDecoder, B>();
  denoiser_laws<SmallMdmTokens, B>();
  denoiser_laws<SmallMdmGru, B>();
}

TEST_CASE("laws of modules and of the tape: MDM") {
  module_laws<SmallMdmEncoder>();
  tape_law<SmallMdmEncoder, ml::EigenBackend<double>>();
  module_laws<SmallMdmDecoder>();
  tape_law<SmallMdmDecoder, ml::EigenBackend<double>>();
  module_laws<SmallMdmTokens>();
  tape_law<SmallMdmTokens, ml::EigenBackend<double>>();
  module_laws<SmallMdmGru>();
  tape_law<SmallMdmGru, ml::EigenBackend<double>>();
}
