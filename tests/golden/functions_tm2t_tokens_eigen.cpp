// Golden functions: TM2T's motion tokenizer over one backend; see tm2t_tokens.hpp.
#include <motionlang/backend/eigen.hpp>

#include "tm2t_tokens.hpp"

static const auto registered = golden::tm2t_tokens::over<motionlang::EigenBackend<float>>("eigen<float>");
