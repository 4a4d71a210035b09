// TEACH and SINC behind the Generator: texts one after the other, texts at the same time.
#pragma once

#include <motionlang/systems/sinc.hpp>
#include <motionlang/systems/teach.hpp>

#include "from_texts.hpp"

namespace program {

using TeachLatents = TextLatents<ml::Teach<ml::EigenBackend<float>>>;
using SincLatents = TextLatents<ml::Sinc<ml::EigenBackend<float>>>;

/// As their repositories leave them.
TeachLatents published_teach(const std::filesystem::path& run, const ModelSources& sources);
SincLatents published_sinc(const std::filesystem::path& run, const ModelSources& sources);
/// Folders of train-teach and train-sinc.
TeachLatents trained_teach(const std::filesystem::path& folder, const ModelSources& sources);
SincLatents trained_sinc(const std::filesystem::path& folder, const ModelSources& sources);

std::unique_ptr<Generator> from_teach(TeachLatents parts);
/// All texts, as one sentence.
std::unique_ptr<Generator> from_sinc(SincLatents parts);

}  // namespace program
