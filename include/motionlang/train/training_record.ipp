// SPDX-License-Identifier: MIT
// Bodies of training_record.hpp.
#pragma once

#include <motionlang/train/training_record.hpp>
#include <motionlang/view/loss_curves.hpp>
#include <motionlang/weights/stmc_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

inline constexpr const char* validations_tensor = "validations";
inline constexpr const char* term_values_tensor = "loss_terms";

inline std::string joined_names(const std::vector<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : "\n") + name;
  return out;
}
inline std::vector<std::string> separate_names(const std::string& text) {
  std::vector<std::string> out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    out.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return out;
}
inline std::string joined_measures(const std::vector<Measure>& measures) {
  std::vector<std::string> names;
  names.reserve(measures.size());
  for (const Measure& m : measures) names.push_back((m.larger_is_better ? "+" : "-") + m.name);
  return joined_names(names);
}
inline std::vector<Measure> separate_measures(const std::string& text) {
  std::vector<Measure> out;
  for (const std::string& line : separate_names(text)) out.push_back({line.substr(1), 0, line[0] == '+'});
  return out;
}

}  // namespace detail

MOTIONLANG_BODY Index TrainingRecord::best() const {
  Index best = -1;
  for (Index i = 0; i < std::ssize(validations); ++i) {
    const auto watched = [&](Index k) -> const Measure& {
      return validations[static_cast<std::size_t>(k)].measures.at(0);
    };
    const double sign = watched(i).larger_is_better ? -1 : 1;
    if (best < 0 || sign * watched(i).value < sign * watched(best).value) best = i;
  }
  return best;
}

MOTIONLANG_BODY bool TrainingRecord::gives_up(const ValidationPlan& plan) const {
  return plan.patience > 0 && !validations.empty() && std::ssize(validations) - 1 - best() >= plan.patience;
}

MOTIONLANG_BODY void TrainingRecord::add(float loss, const std::vector<std::string>& names,
                                         std::span<const float> values) {
  losses.push_back(loss);
  if (names != terms) terms = names, term_values.clear();  // other weights: a term of weight 0 is none
  term_values.insert(term_values.end(), values.begin(), values.end());
}

MOTIONLANG_BODY void TrainingRecord::add_to(TensorStore& store, std::map<std::string, std::string>& metadata) const {
  store.add<float>("losses", {steps()}, losses, DType::F32);
  metadata["training.steps_done"] = std::to_string(steps());
  if (!terms.empty()) {
    const auto count = std::ssize(terms);
    store.add<float>(detail::term_values_tensor, {std::ssize(term_values) / count, count}, term_values, DType::F32);
    metadata["training.terms"] = detail::joined_names(terms);
  }
  if (validations.empty()) return;
  std::vector<double> rows;
  for (const Validation& v : validations) {
    rows.push_back(static_cast<double>(v.step));
    for (const Measure& m : v.measures) rows.push_back(m.value);
  }
  store.add<double>(detail::validations_tensor, {std::ssize(validations), std::ssize(rows) / std::ssize(validations)},
                    rows, DType::F64);
  metadata["training.measures"] = detail::joined_measures(validations.front().measures);
}

MOTIONLANG_BODY void TrainingRecord::load(const SafetensorsFile& file) {
  losses = values_of<float>(file.tensor("losses"));
  if (detail::metadata_number<Index>(file.metadata(), "training.steps_done", file.name()) != steps())
    raise<io_error>(403, file.name(), ": losses of ", counted(steps(), "step"), ", the metadata say otherwise");
  terms = detail::separate_names(detail::metadata_text(file.metadata(), "training.terms", ""));
  term_values.clear();
  if (const auto* values = file.find(detail::term_values_tensor)) {
    term_values = values_of<float>(*values);
    if (values->shape.rank() != 2 || values->shape[0] > steps() || values->shape[1] != std::ssize(terms))
      raise<io_error>(403, file.name(), ": ", detail::term_values_tensor, " ", values->shape, ", named are ",
                      terms.size(), " terms, of ", counted(steps(), "step"));
  }
  validations.clear();
  const auto* stored = file.find(detail::validations_tensor);
  if (stored == nullptr) return;
  const auto names = detail::separate_measures(detail::metadata_text(file.metadata(), "training.measures", ""));
  const auto rows = values_of<double>(*stored);
  const std::size_t width = names.size() + 1;
  if (stored->shape.rank() != 2 || stored->shape[1] != static_cast<Index>(width))
    raise<io_error>(403, file.name(), ": validations ", stored->shape, ", named are ", names.size());
  for (std::size_t at = 0; at < rows.size(); at += width) {
    Validation v{static_cast<Index>(rows[at]), names};
    for (std::size_t i = 0; i < names.size(); ++i) v.measures[i].value = rows[at + 1 + i];
    validations.push_back(std::move(v));
  }
}

MOTIONLANG_BODY std::string TrainingRecord::curves() const {
  std::vector<CurvePanel> panels{{"loss", {curve_of_steps("training", losses)}}};
  for (std::size_t i = 0; !validations.empty() && i < validations.front().measures.size(); ++i) {
    Curve c{"validation", {}, {}};
    for (const Validation& v : validations) {
      c.steps.push_back(static_cast<double>(v.step));
      c.values.push_back(v.measures[i].value);
    }
    const std::string& name = validations.front().measures[i].name;
    if (name == "loss")
      panels.front().curves.push_back(std::move(c));
    else
      panels.push_back({name, {std::move(c)}});
  }
  if (terms.size() > 1) {
    const std::size_t rows = term_values.size() / terms.size(), first = losses.size() - rows;
    CurvePanel panel{"terms of the training loss, weighted",
                     {curve_of_steps("total", std::span(losses).subspan(first), first)}};
    for (std::size_t k = 0; k < terms.size(); ++k) {
      std::vector<float> values;
      for (std::size_t row = 0; row < rows; ++row) values.push_back(term_values[row * terms.size() + k]);
      panel.curves.push_back(curve_of_steps(terms[k], values, first));
    }
    panels.insert(panels.begin() + 1, std::move(panel));
  }
  return curves_svg(panels);
}

MOTIONLANG_BODY void require_same_settings(const SafetensorsFile& checkpoint,
                                           const std::map<std::string, std::string>& settings,
                                           bool with_other_settings) {
  for (const auto& [name, value] : settings) {
    if (with_other_settings && name.starts_with("training.")) continue;
    const std::string before = detail::metadata_text(checkpoint.metadata(), name, "nothing");
    if (value == before) continue;
    const bool is_long = value.size() + before.size() > 100;  // the vocabulary
    raise<config_error>(102, checkpoint.name(), ": this run began with another ", name,
                        is_long ? "" : " (" + before + ", not " + value + ")",
                        "; `fresh` starts anew, another `out` keeps both");
  }
}

MOTIONLANG_NAMESPACE_END
