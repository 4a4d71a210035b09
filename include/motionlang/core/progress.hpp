// SPDX-License-Identifier: MIT
/// Reports the progress of long work to the caller, who may stop it.
#pragma once

#include <memory>       // addressof
#include <type_traits>  // callables

#include <motionlang/core/shape.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A reference to a caller's `bool f(Index done, Index total)`; false stops the work with `cancelled`. It may be empty.
/// Without exceptions, false ends the program like an error, but the C functions can be cancelled (motionlang/c). The
/// callable must outlive it, so a temporary one does not compile.
class Progress {
 public:
  Progress() = default;
  template <class F>
  requires(!std::is_same_v<std::remove_cv_t<F>, Progress> && std::is_invocable_r_v<bool, F&, Index, Index>)
      Progress(F& f)
      : object_(address(f)), call_([](void* object, Index done, Index total) -> bool {
          return (*reinterpret_cast<F*>(object))(done, total);
        }) {}

  /// Throws `cancelled` if the caller returns false.
  void operator()(Index done, Index total) const {
    if (call_ != nullptr && !call_(object_, done, total)) detail::throw_exception(cancelled());
  }

 private:
  template <class F>
  static void* address(F& f) {
    if constexpr (std::is_function_v<F>)
      return reinterpret_cast<void*>(&f);
    else
      return const_cast<void*>(static_cast<const void*>(std::addressof(f)));
  }

  void* object_ = nullptr;
  bool (*call_)(void*, Index, Index) = nullptr;
};

MOTIONLANG_NAMESPACE_END
