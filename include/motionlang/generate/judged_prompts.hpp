// SPDX-License-Identifier: MIT
/// Twelve prompts, and the tests of whether a motion does what its prompt says: how much a model can do, as a table of
/// percentages that can be compared between models and numbers of steps.
///
///     const Judgement j = judge(*model, {}, 10);             // ten seeds of each prompt
///     std::printf("%zu of %zu motions\n", j.done(), j.motions());
#pragma once

#include <functional>  // tests
#include <string>      // prompts
#include <vector>      // motions

#include <motionlang/generate/motion_model.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Measurements of a motion on the 24-joint skeleton, in metres, seconds and degrees.
struct PromptMeasures {
  double speed = 0;    // of the root over the floor, mean
  double forward = 0;  // net displacement along the first heading
  double turned = 0;   // net change of heading, positive to the left
  double lowest_pelvis = 9, last_pelvis = 0, first_pelvis = 0, highest_pelvis = 0;
  double left_hand = -9, right_hand = -9;            // highest wrist above its shoulder
  double both_hands = -9;                            // highest moment of the lower wrist above its shoulder
  double left_hand_speed = 0, right_hand_speed = 0;  // largest, relative to the pelvis
  double left_foot = 0, right_foot = 0;              // highest ankle above the standing height
  double both_feet = 0;                              // highest moment of the lower foot above the floor
  double first_head = 0, lowest_head = 9;
};

PromptMeasures measure_for_prompts(const Motion& motion);

/// A prompt, and what counts as done.
struct JudgedPrompt {
  std::string text{};
  double seconds = 0;
  std::string rule{};  // as a table prints it
  std::function<bool(const PromptMeasures&)> done{};
};

/// Prompts for movements that the free data show often: each describes 19 segments or more (walking backwards) and up
/// to 105 (bending).
const std::vector<JudgedPrompt>& judged_prompts();

/// The measurements of all prompts with all seeds. Means are over the motions.
struct Judgement {
  std::vector<std::vector<PromptMeasures>> results{};  // of each prompt, seed by seed
  std::vector<std::vector<Vec3<double>>> positions{};  // of each motion (frames, joints), seed by seed
  double skate = 0, jitter = 0;                        // m/s, m/s^3
  double bones = 0;    // largest change of the length of a bone between predicted positions, as a share of it
  double seconds = 0;  // of the processor for a second of motion

  /// Motions that do what a prompt says, of one prompt and of all.
  std::size_t done(std::size_t prompt) const;
  std::size_t done() const;
  std::size_t motions() const { return positions.size(); }
};

/// Makes all prompts with the seeds 0, 1, ... and measures them. The seed and the notes of the options have no effect;
/// their progress counts the steps of all seeds. Throws option_error 101 unless seeds is 1 or more, and what
/// generate_motions throws.
Judgement judge(const MotionModel& model, const GenerateOptions& options, int seeds);

/// Mean distance of joints between two judgements, metres; `shift` motions further on in the second.
double mean_distance(const Judgement& a, const Judgement& b, std::size_t shift = 0);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/generate/judged_prompts.ipp>
#endif
