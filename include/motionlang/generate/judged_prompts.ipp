// SPDX-License-Identifier: MIT
// Bodies of judged_prompts.hpp.
#pragma once

#include <algorithm>  // min, max
#include <cmath>      // hypot
#include <ctime>      // time of the processor
#include <numbers>    // pi

#include <motionlang/features/smplrifke.hpp>
#include <motionlang/generate/judged_prompts.hpp>
#include <motionlang/kinematics/loops.hpp>
#include <motionlang/metrics/motion_quality.hpp>

MOTIONLANG_NAMESPACE_BEGIN

MOTIONLANG_BODY PromptMeasures measure_for_prompts(const Motion& m) {
  PromptMeasures r;
  JointTransforms<double> world;
  const Index n = m.frames();
  double floor = 9, path = 0, turned = 0, before = 0;
  std::vector<std::vector<Vec3<double>>> frames;
  for (Index f = 0; f < n; ++f) {
    m.world(f, world);
    frames.push_back(world.position);
    for (const auto& p : world.position) floor = std::min(floor, p.y);
    const double heading = detail::heading(m.rotations(f)[0]);
    if (f > 0) {
      turned += std::remainder(heading - before, 2 * std::numbers::pi);
      const auto d = m.root_at(f) - m.root_at(f - 1);
      path += std::hypot(d.x, d.z);
    }
    before = heading;
  }
  for (Index f = 0; f < n; ++f) {
    const auto& p = frames[static_cast<std::size_t>(f)];
    const double left = p[20].y - p[16].y, right = p[21].y - p[17].y;
    r.left_hand = std::max(r.left_hand, left);
    r.right_hand = std::max(r.right_hand, right);
    r.both_hands = std::max(r.both_hands, std::min(left, right));
    r.lowest_pelvis = std::min(r.lowest_pelvis, p[0].y - floor);
    r.highest_pelvis = std::max(r.highest_pelvis, p[0].y - floor);
    r.lowest_head = std::min(r.lowest_head, p[15].y - floor);
    r.left_foot = std::max(r.left_foot, p[7].y - floor);
    r.right_foot = std::max(r.right_foot, p[8].y - floor);
    r.both_feet = std::max(r.both_feet, std::min(p[10].y, p[11].y) - floor);
    if (f > 0) {
      const auto& q = frames[static_cast<std::size_t>(f) - 1];
      r.left_hand_speed = std::max(r.left_hand_speed, m.fps * norm((p[20] - p[0]) - (q[20] - q[0])));
      r.right_hand_speed = std::max(r.right_hand_speed, m.fps * norm((p[21] - p[0]) - (q[21] - q[0])));
    }
  }
  r.first_head = frames.front()[15].y - floor;
  r.first_pelvis = frames.front()[0].y - floor;
  r.last_pelvis = frames.back()[0].y - floor;
  r.speed = path / std::max(1e-9, static_cast<double>(n - 1) / m.fps);
  r.turned = turned * 180 / std::numbers::pi;
  const auto d = rotate(detail::turn(-detail::heading(m.rotations(0)[0])), m.root_at(n - 1) - m.root_at(0));
  r.forward = d.z;
  return r;
}

MOTIONLANG_BODY const std::vector<JudgedPrompt>& judged_prompts() {
  static const std::vector<JudgedPrompt> list{
      {"walk forward", 4, "goes > 2 m ahead at 0.5 to 1.9 m/s",
       [](const PromptMeasures& m) { return m.forward > 2 && m.speed > 0.5 && m.speed < 1.9; }},
      {"run forward", 3, "faster than 1.8 m/s", [](const PromptMeasures& m) { return m.speed > 1.8; }},
      {"walk backwards", 3, "goes > 0.6 m back", [](const PromptMeasures& m) { return m.forward < -0.6; }},
      {"walk slowly", 4, "0.25 to 1.1 m/s", [](const PromptMeasures& m) { return m.speed > 0.25 && m.speed < 1.1; }},
      {"stand still", 4, "slower than 0.15 m/s, pelvis stays up",
       [](const PromptMeasures& m) { return m.speed < 0.15 && m.lowest_pelvis > 0.75; }},
      {"turn left", 3, "turns > 45 degrees left", [](const PromptMeasures& m) { return m.turned > 45; }},
      {"turn right", 3, "turns > 45 degrees right", [](const PromptMeasures& m) { return m.turned < -45; }},
      {"raise both arms", 3, "both wrists > 0.15 m above the shoulders at once",
       [](const PromptMeasures& m) { return m.both_hands > 0.15; }},
      {"raise the right arm", 3, "only the right wrist > 0.1 m above its shoulder",
       [](const PromptMeasures& m) { return m.right_hand > 0.1 && m.left_hand < 0.1; }},
      {"sit down", 3, "pelvis ends > 0.2 m lower",
       [](const PromptMeasures& m) { return m.first_pelvis - m.last_pelvis > 0.2; }},
      {"jump forward", 2.5, "both feet > 0.1 m up, > 0.4 m ahead",
       [](const PromptMeasures& m) { return m.both_feet > 0.1 && m.forward > 0.4; }},
      {"bend forward", 3, "head comes > 0.25 m lower, pelvis stays above 0.6 m",
       [](const PromptMeasures& m) { return m.first_head - m.lowest_head > 0.25 && m.lowest_pelvis > 0.6; }},
  };
  return list;
}

namespace detail {

/// Positions of joints that the features say, as they are, instead of the rotations: bones may change their lengths.
inline double bone_change(const std::vector<double>& features) {
  std::vector<Vec3<double>> positions;
  for (std::size_t at = 0; at < features.size(); at += smplrifke_size) {
    positions.push_back({});
    for (std::size_t j = at + 136; j < at + 205; j += 3)
      positions.push_back({features[j], features[j + 1], features[j + 2]});
  }
  return bone_length_deviation({positions, smplrifke_joints}, smpl24_skeleton().parents);
}

}  // namespace detail

MOTIONLANG_BODY std::size_t Judgement::done(std::size_t prompt) const {
  return static_cast<std::size_t>(
      std::count_if(results[prompt].begin(), results[prompt].end(), judged_prompts()[prompt].done));
}
MOTIONLANG_BODY std::size_t Judgement::done() const {
  std::size_t n = 0;
  for (std::size_t i = 0; i < results.size(); ++i) n += done(i);
  return n;
}

MOTIONLANG_BODY Judgement judge(const MotionModel& model, const GenerateOptions& options, int seeds) {
  if (seeds < 1) raise<option_error>(101, "judge: ", seeds, " seeds");
  const auto& prompts = judged_prompts();
  Judgement out;
  out.results.resize(prompts.size());
  std::vector<Timeline> timelines;
  double length = 0;
  for (const JudgedPrompt& p : prompts) {
    timelines.push_back(whole_body_timeline(p.text, frame_at(p.seconds, model.fps())));
    length += p.seconds;
  }
  GenerateNotes notes;
  GenerateOptions how = options;
  how.notes = &notes;
  for (int seed = 0; seed < seeds; ++seed) {
    how.seed = static_cast<std::uint64_t>(seed);
    auto steps = [&](Index done, Index total) { return options.progress(seed * total + done, seeds * total), true; };
    how.progress = steps;
    const std::clock_t start = std::clock();
    const auto motions = generate_motions(model, timelines, how);
    out.seconds += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / (length * seeds);
    for (std::size_t i = 0; i < motions.size(); ++i) {
      out.results[i].push_back(measure_for_prompts(motions[i]));
      out.positions.push_back(motions[i].positions());
      const auto quality = motion_quality(motions[i]);
      out.skate += quality.feet.speed;
      out.jitter += quality.jitter;
      if (notes.layout == "smplrifke") out.bones += detail::bone_change(notes.features[i]);
    }
  }
  for (double* sum : {&out.skate, &out.jitter, &out.bones})
    *sum /= static_cast<double>(std::max<std::size_t>(1, out.motions()));
  return out;
}

MOTIONLANG_BODY double mean_distance(const Judgement& a, const Judgement& b, std::size_t shift) {
  double sum = 0;
  std::size_t joints = 0;
  for (std::size_t i = 0; i + shift < a.motions(); ++i) {
    const auto &p = a.positions[i], &q = b.positions[i + shift];
    for (std::size_t j = 0; j < p.size(); ++j) sum += norm(p[j] - q[j]);
    joints += p.size();
  }
  return joints == 0 ? 0 : sum / static_cast<double>(joints);
}

MOTIONLANG_NAMESPACE_END
