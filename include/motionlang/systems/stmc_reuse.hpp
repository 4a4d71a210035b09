// SPDX-License-Identifier: MIT
/// How much a run of STMC reused of the run before (systems/stmc_edit.hpp).
#pragma once

#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// How much a run reused.
struct StmcReuse {
  Index frames = 0, kept = 0;      // of the result; those that have the numbers of before
  Index work = 0, whole_work = 0;  // rows through the network in all steps; in a run that takes nothing over
  Index steps = 0;                 // of the run
  Index everywhere = 0;  // the step (from 1) after which no frame of an edited timeline is that of before; 0: none is
  bool exact = true;     // the result is that of a run that takes nothing over, bit for bit
};

MOTIONLANG_NAMESPACE_END
