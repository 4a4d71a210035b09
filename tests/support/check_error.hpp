// SPDX-License-Identifier: MIT
/// Checks that an expression is refused with an error of the library.
#pragma once

#include <doctest/doctest.h>

#include <motionlang/core/error.hpp>

/// `text` is a part of the message, usually its id: CHECK_ERROR(a + b, "[motionlang.shape.202]").
#define CHECK_ERROR(expression, text) CHECK_THROWS_WITH_AS(expression, doctest::Contains(text), motionlang::error)
