// Golden functions: TM2T's transformers over one backend; see tm2t_transformers.hpp.
#include <motionlang/backend/eigen.hpp>

#include "tm2t_transformers.hpp"

static const auto registered = golden::tm2t_transformers::over<motionlang::EigenBackend<float>>("eigen<float>");
