// SPDX-License-Identifier: MIT
// Bodies of the headers in core/, compiled once for motionlang::instantiated.
#include <motionlang/core/buffer_pool.ipp>
#include <motionlang/core/error.ipp>
#include <motionlang/core/instruction_set.ipp>
#include <motionlang/core/large_memory.ipp>
#include <motionlang/core/lifetime.ipp>
#include <motionlang/core/offsets.ipp>
#include <motionlang/core/parallel.ipp>
#include <motionlang/core/processors.ipp>
#include <motionlang/core/quantile.ipp>
#include <motionlang/core/rounding.ipp>
#include <motionlang/core/shape.ipp>
#include <motionlang/core/text_encoding.ipp>
#include <motionlang/core/utf8.ipp>
