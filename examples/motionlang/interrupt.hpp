// The flag that Ctrl-C sets.
#pragma once

#include <atomic>

namespace program {

/// True after Ctrl-C. Long work checks it between steps, ends cleanly, and leaves nothing half written.
inline std::atomic<bool> interrupted{false};

}  // namespace program
