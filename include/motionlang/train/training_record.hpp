// SPDX-License-Identifier: MIT
/// The history of a training: losses, their terms, validations. It is part of every checkpoint.
#pragma once

#include <map>     // metadata
#include <span>    // values
#include <string>  // names
#include <vector>  // values

#include <motionlang/core/shape.hpp>
#include <motionlang/file/safetensors.hpp>
#include <motionlang/weights/module_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// One value that a validation measured.
struct Measure {
  std::string name;
  double value = 0;
  bool larger_is_better = false;
};
struct Validation {
  Index step = 0;
  std::vector<Measure> measures;  // the first decides which weights are the best
};

/// When to validate, and when to stop early.
struct ValidationPlan {
  Index every = 0;         // steps; 0: never
  Index patience = 0;      // validations without an improvement before training stops; 0: never
  bool keep_best = false;  // export the weights of the best validation, not the last ones
};

struct TrainingRecord {
  std::vector<float> losses;       // of every step
  std::vector<std::string> terms;  // of the loss: those of the last step
  std::vector<float> term_values;  // weighted, (steps, terms): of the last steps that had these terms
  std::vector<Validation> validations;

  Index steps() const { return std::ssize(losses); }
  /// The number of the best validation, -1 without one.
  Index best() const;
  /// True if training stops early.
  bool gives_up(const ValidationPlan& plan) const;
  void add(float loss, const std::vector<std::string>& names, std::span<const float> values);
  void add_to(TensorStore& store, std::map<std::string, std::string>& metadata) const;
  /// Throws io_error 403 if the tensors and the metadata of a checkpoint do not fit each other.
  void load(const SafetensorsFile& file);
  /// A picture (SVG): the loss of training and validation, and below it its terms and the other measures.
  std::string curves() const;
};

/// Throws config_error 102 for the first setting in which a checkpoint differs; "training.*" may differ if allowed.
void require_same_settings(const SafetensorsFile& checkpoint, const std::map<std::string, std::string>& settings,
                           bool with_other_settings);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/training_record.ipp>
#endif
