// Motions on a body. A unit of its own, because its backend takes time to compile.
#include <motionlang/backend/eigen.hpp>
#include <motionlang/view/load_shown_body.hpp>

#include "motion_files.hpp"

namespace program {

std::unique_ptr<const ml::ShownBody> shown_body(const ml::ShownBodyOptions& options) {
  return options.file.empty() ? nullptr : ml::load_shown_body<ml::EigenBackend<float>>(options);
}

}  // namespace program
