// SPDX-License-Identifier: MIT
/// The report on how much a run of STMC reused of the run before (systems/stmc_edit.hpp).
#pragma once

#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The amount that a run reused.
struct StmcReuse {
  Index frames = 0, kept = 0;      // of the result; those with unchanged values
  Index work = 0, whole_work = 0;  // rows through the network in all steps; in a run without reuse
  Index steps = 0;                 // of the run
  Index everywhere = 0;  // the step (from 1) after which no frame of an edited timeline is unchanged; 0: there is none
  bool exact = true;     // the result equals that of a run without reuse, bit for bit
};

MOTIONLANG_NAMESPACE_END
