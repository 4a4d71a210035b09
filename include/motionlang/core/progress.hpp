// SPDX-License-Identifier: MIT
/// How long work tells its caller where it is, and how the caller stops it.
#pragma once

#include <type_traits>  // callables

#include <motionlang/core/shape.hpp>

namespace motionlang::inline MOTIONLANG_ABI {

/// A reference to a caller's `bool f(Index done, Index total)`; false stops the work with `cancelled`. May be empty.
/// Like a pointer: the callable must outlive it, so a temporary one does not compile.
class Progress {
 public:
  Progress() = default;
  template <class F>
  requires(!std::is_same_v<std::remove_cv_t<F>, Progress> && std::is_invocable_r_v<bool, F&, Index, Index>)
      Progress(F& f)
      : object_(const_cast<void*>(static_cast<const void*>(&f))),
        call_([](void* object, Index done, Index total) -> bool { return (*static_cast<F*>(object))(done, total); }) {}

  /// Throws `cancelled` if the caller answers false.
  void operator()(Index done, Index total) const {
    if (call_ != nullptr && !call_(object_, done, total)) throw cancelled();
  }

 private:
  void* object_ = nullptr;
  bool (*call_)(void*, Index, Index) = nullptr;
};

}  // namespace motionlang::inline MOTIONLANG_ABI
