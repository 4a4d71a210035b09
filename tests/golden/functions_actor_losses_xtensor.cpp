// Golden functions: ACTOR's loss over one backend; see actor_losses.hpp.
#include <motionlang/backend/xtensor.hpp>

#include "actor_losses.hpp"

static const auto registered = golden::actor_losses::over<motionlang::XtensorBackend<float>>("xtensor<float>");
