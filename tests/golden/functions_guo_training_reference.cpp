// Golden functions: Guo's evaluator in training over one backend; see guo_training.hpp.
#include <motionlang/backend/reference.hpp>

#include "guo_training.hpp"

static const auto registered = golden::guo_training::over<motionlang::ReferenceBackend<double>>("reference<double>");
