// SPDX-License-Identifier: MIT
// Bodies of the headers about motions that a model remembers, compiled once for motionlang::instantiated. They are a
// unit of their own, because a program with STMC needs them, and no other data sets.
#include <motionlang/datasets/motion_memory.ipp>
#include <motionlang/weights/motion_memory_file.ipp>
