// Every noise schedule, short and long.
#include "schedule_laws.hpp"

namespace ml = motionlang;

TEST_CASE("laws of schedules") {
  for (ml::Index steps : {1, 2, 50, 100, 1000}) {
    INFO(steps, " steps");
    if (steps != 2) laws::schedule_laws(ml::LinearSchedule{.steps = steps});  // two steps would need a beta of 10
    laws::schedule_laws(ml::LinearSchedule{.steps = steps, .scale_betas = 0.02});
    laws::schedule_laws(ml::ScaledLinearSchedule{.steps = steps});
    laws::schedule_laws(ml::CosineSchedule{.steps = steps});
    laws::schedule_laws(ml::ChenCosineSchedule{.steps = steps});
    laws::schedule_laws(ml::ChenCosineSchedule{.steps = steps, .start = 0.2, .end = 0.9, .tau = 2});
  }
  laws::schedule_laws(ml::BetaList{{0.5, 0.1, 0.9, 0.999, 1e-5}});
}
