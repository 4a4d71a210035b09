// Golden functions: TM2T's recurrent model over one backend; see tm2t_gru.hpp.
#include <motionlang/backend/eigen.hpp>

#include "tm2t_gru.hpp"

static const auto registered = golden::tm2t_gru::over<motionlang::EigenBackend<float>>("eigen<float>");
