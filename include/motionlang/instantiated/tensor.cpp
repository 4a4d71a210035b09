// SPDX-License-Identifier: MIT
// Bodies of the headers in tensor/, compiled once for motionlang::instantiated.
#include <motionlang/tensor/id_sequences.ipp>
#include <motionlang/tensor/index.ipp>
#include <motionlang/tensor/print.ipp>
#include <motionlang/tensor/sequences.ipp>
