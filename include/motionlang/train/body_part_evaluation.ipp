// SPDX-License-Identifier: MIT
// Bodies of body_part_evaluation.hpp.
#pragma once

#include <algorithm>  // copy
#include <map>        // answers by label

#include <motionlang/core/formatted.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/kinematics/sinc_part_motion.hpp>
#include <motionlang/metrics/accuracy.hpp>
#include <motionlang/train/body_part_evaluation.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// Pairs of predictions and truths, six numbers each.
struct ComparedParts {
  std::vector<double> predicted{}, wanted{};

  void add(const SincParts& parts, std::span<const double> truth) {
    for (std::size_t p = 0; p < sinc_part_count; ++p) predicted.push_back(parts[p] ? 1 : 0);
    wanted.insert(wanted.end(), truth.begin(), truth.end());
  }
  PartAccuracy accuracy() const {
    constexpr Index width = sinc_part_count;
    const auto shares = answer_accuracies(Rows(std::span(predicted), width), Rows(std::span(wanted), width));
    PartAccuracy out;
    std::copy(shares.begin(), shares.end(), out.of_parts.begin());
    out.items = std::ssize(predicted) / width;
    return out;
  }
};

inline std::span<const double> truth_of(const BodyPartTruth& truth, std::size_t label) {
  return std::span(truth.wanted).subspan(label * sinc_part_count, sinc_part_count);
}

}  // namespace detail

MOTIONLANG_BODY PartAccuracy part_accuracy(
    const BodyPartTruth& truth, const std::function<std::optional<SincParts>(const std::string& label)>& labeller) {
  detail::ComparedParts compared;
  for (std::size_t i = 0; i < truth.labels.size(); ++i) {
    if (const auto parts = labeller(truth.labels[i])) compared.add(*parts, detail::truth_of(truth, i));
  }
  return compared.accuracy();
}

MOTIONLANG_BODY std::function<std::optional<SincParts>(const std::string& label)> answered_parts(
    const BodyPartAnswers& answers) {
  std::map<std::string, SincParts> known;
  for (const auto& [label, answer] : answers) {
    const auto parts = known_body_part_answer(answer);
    known[label] = parts ? *parts : as_sinc_parts(guess_body_parts(answer));
  }
  return [known = std::move(known)](const std::string& label) -> std::optional<SincParts> {
    const auto found = known.find(label);
    return found == known.end() ? std::nullopt : std::optional(found->second);
  };
}

MOTIONLANG_BODY PartAccuracy velocity_part_accuracy(const BodyPartTruth& truth,
                                                    const std::vector<DescribedMotion>& motions,
                                                    const std::string& features, double threshold) {
  const MotionFeatures& f = motion_features(features);
  std::map<std::string, std::size_t> number;
  for (std::size_t i = 0; i < truth.labels.size(); ++i) number.emplace(truth.labels[i], i);
  detail::ComparedParts compared;
  for (const DescribedMotion& m : motions) {
    const auto found = m.texts.size() == 1 ? number.find(m.texts.front().text) : number.end();
    if (found == number.end()) continue;
    const std::vector<double> rows(m.rows.begin(), m.rows.end());
    const auto all = f.joints_of(rows);
    std::vector<Vec3<double>> joints;  // the first 22 of each frame
    const auto count = static_cast<std::size_t>(f.joints);
    for (std::size_t frame = 0; frame < all.size() / count; ++frame)
      joints.insert(joints.end(), all.begin() + static_cast<std::ptrdiff_t>(frame * count),
                    all.begin() + static_cast<std::ptrdiff_t>(frame * count + sinc_part_of_joint.size()));
    if (joints.size() < 2 * sinc_part_of_joint.size()) continue;
    compared.add(moving_sinc_parts(sinc_part_speeds(std::span<const Vec3<double>>(joints)), threshold),
                 detail::truth_of(truth, found->second));
  }
  return compared.accuracy();
}

MOTIONLANG_BODY std::vector<LabellerAccuracy> labeller_accuracies(const BodyPartTruth& truth,
                                                                  const std::vector<DescribedMotion>* motions,
                                                                  const BodyPartAnswers* answers) {
  std::vector<LabellerAccuracy> out;
  if (motions != nullptr) out.push_back({"velocities of motions", velocity_part_accuracy(truth, *motions, "smplvelp")});
  out.push_back({"words of the label (lexicon)", part_accuracy(truth, [](const std::string& label) {
                   return std::optional(as_sinc_parts(guess_body_parts(label)));
                 })});
  if (answers != nullptr) out.push_back({"answers", part_accuracy(truth, answered_parts(*answers))});
  return out;
}

MOTIONLANG_BODY std::string labellers_table(const BodyPartTruth& truth, std::span<const LabellerAccuracy> rows) {
  std::string out = counted(truth.labels.size(), "label") + formatted("\n  %-30s", "");
  for (const auto part : sinc_part_names) out += formatted("%11s", std::string(part).c_str());
  out += formatted("%8s%8s\n", "mean", "items");
  for (const auto& [labeller, accuracy] : rows) {
    out += formatted("  %-30s", labeller.c_str());
    for (const double x : accuracy.of_parts) out += formatted("%11.2f", x);
    out += formatted("%8.2f%8td\n", accuracy.mean(), accuracy.items);
  }
  return out;
}

MOTIONLANG_BODY std::vector<DescribedMotion> labelled_motions(const BabelSources& sources, Progress progress) {
  SincDataConfig config;
  config.types = "seg+seq";
  config.test_share = config.validation_share = 0;
  return read_babel_motions(sources, "smplvelp", split_config(config), sinc_reader(config), progress).training;
}

MOTIONLANG_NAMESPACE_END
