// ACTOR as a model with one latent for every motion.
#pragma once

#include <functional>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/systems/actor.hpp>

#include "from_latent.hpp"

namespace program {

/// ACTOR with what turns its rows into clips and back.
struct ActorLatents {
  ml::Actor<ml::EigenBackend<float>> model;
  std::vector<std::string> labels;
  double fps = 20;
  ml::Index longest = 60;
  std::function<ml::Motion(std::span<const float>)> motion_of;  // on the floor
  std::function<std::vector<double>(const ml::Motion&)> rows_of;
};
std::unique_ptr<Generator> from_actions(ActorLatents actor);

}  // namespace program
