// SPDX-License-Identifier: MIT
// Bodies of the headers in train/ that generate/ uses, too, compiled once for motionlang::instantiated. They need no
// other body of train/, and so a program that only generates links none.
#include <motionlang/train/communicator.ipp>
#include <motionlang/train/messages.ipp>
#include <motionlang/train/shared_items.ipp>
#include <motionlang/train/shared_progress.ipp>
