// Ctrl-C, as work sees it.
#pragma once

#include <atomic>

namespace program {

/// Set by Ctrl-C. Long work looks at it between steps, ends cleanly, and leaves nothing half written.
inline std::atomic<bool> interrupted{false};

}  // namespace program
