// SPDX-License-Identifier: MIT
/// Models that make no real motions, for tests of what is around them.
#pragma once

#include <motionlang/generate/latent_motion_model.hpp>

#include "../../support/synthetic_motion.hpp"

namespace fake {

namespace ml = motionlang;

/// Says of itself what it is made with, and makes one frame for each motion.
struct Model final : ml::MotionModel {
  ml::Index diffusion_steps = 0;
  bool timelines = false, actions = false, latents = false;
  ml::KnownWords known{};
  ml::KnownCaptions learned{};
  ml::TextLength length{};
  mutable int calls = 0;

  double fps() const override { return 20; }
  std::string system() const override { return "a fake model"; }
  ml::Index steps() const override { return diffusion_steps; }
  bool takes_timelines() const override { return timelines; }
  bool takes_actions() const override { return actions; }
  bool draws_latents() const override { return latents; }
  const ml::KnownWords& words() const override { return known; }
  const ml::KnownCaptions& captions() const override { return learned; }
  ml::TextLength length_of(const std::string&) const override { return length; }

 private:
  std::vector<ml::Motion> make(std::span<const ml::Timeline> all, const ml::GenerateOptions&) const override {
    ++calls;
    std::vector<ml::Motion> out;
    for (const ml::Timeline& t : all) {
      out.push_back(synthetic::walk({.frames = 2}));
      out.back().name = t.intervals.front().text + " " + std::to_string(out.size());
    }
    return out;
  }
};

/// Its latent of a text is how fast the figure turns, in the text; its motions are walks. The noise moves the root.
struct Latent final : ml::LatentMotionModel {
  double fps() const override { return 20; }

 private:
  ml::Motion walk(double turn, ml::Philox noise) const {
    float moved = 0;
    noise.normal(std::span<float>(&moved, 1));
    ml::Motion out = synthetic::walk({.frames = 30, .turn = turn});
    for (auto& p : out.root) p.x += static_cast<double>(moved);
    return out;
  }
  static double turn_of(const ml::Timeline& timeline) { return std::stod(ml::only_text(timeline).text); }

  ml::Motion motion(const ml::Timeline& timeline, ml::Philox noise, const ml::GenerateOptions&) const override {
    return walk(turn_of(timeline), noise);
  }
  std::vector<ml::Motion> line(const ml::Timeline& from, const ml::Timeline& to, ml::Index count, ml::Philox noise,
                               double) const override {
    std::vector<ml::Motion> out;
    for (ml::Index i = 0; i < count; ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(count - 1);
      out.push_back(walk(turn_of(from) * (1 - share) + turn_of(to) * share, noise));
    }
    return out;
  }
  /// The same somewhere else.
  ml::Motion decoded(const ml::Motion& motion, const std::string&) const override {
    if (motion.frames() > longest()) throw std::logic_error("too long");
    ml::Motion out = motion;
    for (auto& p : out.root) p.x += 3, p.z -= 1;
    return out;
  }
  ml::Index longest() const override { return 20; }
  ml::Motion on_its_joints(const ml::Motion& motion) const override { return motion; }
};

}  // namespace fake
