// SPDX-License-Identifier: MIT
// A constant configuration that cannot work: the compiler finds it where the program would throw.
// expect: raise.*config_error
#include <motionlang/nn/transformer_encoder.hpp>

#ifdef MISTAKE
constexpr auto config = motionlang::TransformerConfig{.d_model = 512, .heads = 6}.checked();
#else
constexpr auto config = motionlang::TransformerConfig{.d_model = 512, .heads = 8}.checked();
#endif
