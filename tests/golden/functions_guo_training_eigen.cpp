// Golden functions: Guo's evaluator in training over one backend; see guo_training.hpp.
#include <motionlang/backend/eigen.hpp>

#include "guo_training.hpp"

static const auto registered = golden::guo_training::over<motionlang::EigenBackend<float>>("eigen<float>");
