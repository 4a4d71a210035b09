// The models that `generate`, `judge`, `convert` and `evaluate` load, and the options of the command line that these
// models take.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include <motionlang/generate/latent_motion_model.hpp>
#include <motionlang/generate/motion_model_place.hpp>

#include <CLI/CLI.hpp>

#include "../usage_error.hpp"

namespace program {

namespace ml = motionlang;

inline constexpr const char* recall_help =
    "Share of a motion that the weights remember for a text; 0 leaves everything to the network. The default is 0.9";

/// Calls ml::load_motion_model. backend: eigen, xtensor or reference. Throws usage_error 103 for another backend, or
/// for one other than eigen if texts or actions do not go through STMC. Throws 102 for sources that the model does not
/// take.
std::unique_ptr<ml::MotionModel> load_generator(const std::string& backend, const std::filesystem::path& model,
                                                const ml::ModelSources& sources = {});

// A loader for each backend, in its own translation unit.
std::unique_ptr<ml::MotionModel> load_eigen(const ml::MotionModelPlace& place, const ml::ModelSources& sources);
std::unique_ptr<ml::MotionModel> load_xtensor(const ml::MotionModelPlace& place, const ml::ModelSources& sources);
std::unique_ptr<ml::MotionModel> load_reference(const ml::MotionModelPlace& place, const ml::ModelSources& sources);
/// Models of train-temos, train-sinc, train-teach, train-tmr and train-actor, and of a published TMR.
std::unique_ptr<ml::MotionModel> load_trained(const ml::MotionModelPlace& place, const ml::ModelSources& sources);

/// Casts to a model with a latent for every motion. Throws usage_error 102 for another.
/// option  the option that needs it;   model   where it was loaded from
const ml::LatentMotionModel& require_latent(const ml::MotionModel& generator, const std::string& option,
                                            const std::filesystem::path& model);

/// Adds --sampler, which takes one of ml::sampler_names. An empty name stands for the sampler of the model.
CLI::Option* sampler_option(CLI::App& command, std::string& sampler);

}  // namespace program
