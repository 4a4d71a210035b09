// What a folder of a model says about motions, texts or actions, and networks: for `info`.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <motionlang/weights/run_folder.hpp>

namespace program {

/// Lines of a name and a value each. Of ACTOR, TEMOS, TEACH, SINC, TMR, TM2T and MDM's models of actions as published,
/// sizes from their tensors; of folders of our own trainings what their config.json says; nothing of others.
/// Throws what the readers of these folders throw.
std::vector<std::pair<std::string, std::string>> model_summary(const motionlang::RunFolder& run);

}  // namespace program
