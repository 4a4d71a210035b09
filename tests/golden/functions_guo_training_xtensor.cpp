// Golden functions: Guo's evaluator in training over one backend; see guo_training.hpp.
#include <motionlang/backend/xtensor.hpp>

#include "guo_training.hpp"

static const auto registered = golden::guo_training::over<motionlang::XtensorBackend<float>>("xtensor<float>");
