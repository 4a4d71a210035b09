// SPDX-License-Identifier: MIT
/// Objects of which every thread has its own.
#pragma once

#include <cstdlib>  // abort

#include <motionlang/version.hpp>

// MinGW's GCC frees the memory of thread_local variables before it destroys them, so there the system keeps them.
#if defined(_WIN32) && !defined(__clang__)
#define MOTIONLANG_SYSTEM_KEEPS_THREAD_OBJECTS
extern "C" {
__declspec(dllimport) unsigned long __stdcall FlsAlloc(void(__stdcall* at_end)(void*));
__declspec(dllimport) void* __stdcall FlsGetValue(unsigned long key);
__declspec(dllimport) int __stdcall FlsSetValue(unsigned long key, void* value);
}
#endif

MOTIONLANG_NAMESPACE_BEGIN

/// The calling thread's T. It is made at first use and destroyed when the thread ends. `Tag` distinguishes objects of
/// one type.
template <class T, class Tag = T>
T& thread_object() {
#ifdef MOTIONLANG_SYSTEM_KEEPS_THREAD_OBJECTS
  struct AtEnd {
    static void __stdcall call(void* object) { delete static_cast<T*>(object); }
  };
  static const unsigned long key = ::FlsAlloc(&AtEnd::call);
  void* object = ::FlsGetValue(key);
  if (object == nullptr && ::FlsSetValue(key, object = new T) == 0) std::abort();
  return *static_cast<T*>(object);
#else
  thread_local T object;
  return object;
#endif
}

MOTIONLANG_NAMESPACE_END
