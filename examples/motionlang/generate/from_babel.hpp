// TEACH and SINC behind the Generator: texts one after the other, texts at the same time.
#pragma once

#include <motionlang/systems/sinc.hpp>
#include <motionlang/systems/teach.hpp>

#include "from_texts.hpp"

namespace program {

std::unique_ptr<Generator> from_teach(TextLatents<ml::Teach<ml::EigenBackend<float>>> parts);
/// All texts, as one sentence.
std::unique_ptr<Generator> from_sinc(TextLatents<ml::Sinc<ml::EigenBackend<float>>> parts);

}  // namespace program
