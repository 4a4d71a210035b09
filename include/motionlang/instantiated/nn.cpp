// SPDX-License-Identifier: MIT
// Bodies of the headers in nn/, compiled once for motionlang::instantiated.
#include <motionlang/nn/conv1d.ipp>
#include <motionlang/nn/decoding.ipp>
#include <motionlang/nn/gru.ipp>
#include <motionlang/nn/init.ipp>
#include <motionlang/nn/sequence_groups.ipp>
#include <motionlang/nn/vector_quantizer.ipp>
