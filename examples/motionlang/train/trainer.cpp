#include "trainer.hpp"

#include <motionlang/io/stmc_file.hpp>

#include "loss_curves.hpp"

namespace program {

namespace {

/// Where the training loss ends and the measures of validations begin.
constexpr const char* validations_name = "validations";

std::string joined(const std::vector<Measure>& measures) {
  std::string out;
  for (const Measure& m : measures)
    out += (out.empty() ? "" : "\n") + (m.larger_is_better ? "+" + m.name : "-" + m.name);
  return out;
}
std::vector<Measure> separated(const std::string& text) {
  std::vector<Measure> out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    out.push_back({text.substr(at + 1, end - at - 1), 0, text[at] == '+'});
    at = end + 1;
  }
  return out;
}

}  // namespace

ml::Index TrainingRecord::best() const {
  ml::Index best = -1;
  for (ml::Index i = 0; i < std::ssize(validations); ++i) {
    const auto watched = [&](ml::Index k) -> const Measure& {
      return validations[static_cast<std::size_t>(k)].measures.at(0);
    };
    const double sign = watched(i).larger_is_better ? -1 : 1;
    if (best < 0 || sign * watched(i).value < sign * watched(best).value) best = i;
  }
  return best;
}

bool TrainingRecord::gives_up(const ValidationPlan& plan) const {
  return plan.patience > 0 && !validations.empty() && std::ssize(validations) - 1 - best() >= plan.patience;
}

void TrainingRecord::add_to(ml::TensorStore& store, std::map<std::string, std::string>& metadata) const {
  store.add<float>("losses", {steps()}, losses, ml::DType::F32);
  metadata["training.steps_done"] = std::to_string(steps());
  if (validations.empty()) return;
  std::vector<double> rows;
  for (const Validation& v : validations) {
    rows.push_back(static_cast<double>(v.step));
    for (const Measure& m : v.measures) rows.push_back(m.value);
  }
  store.add<double>(validations_name, {std::ssize(validations), std::ssize(rows) / std::ssize(validations)}, rows,
                    ml::DType::F64);
  metadata["training.measures"] = joined(validations.front().measures);
}

void TrainingRecord::load(const ml::SafetensorsFile& file) {
  losses = ml::values_of<float>(file.tensor("losses"));
  if (ml::detail::metadata_number<ml::Index>(file.metadata(), "training.steps_done", file.name()) != steps())
    ml::raise<ml::io_error>(403, file.name(), ": losses of ", steps(), " steps, the metadata say otherwise");
  validations.clear();
  const auto* stored = file.find(validations_name);
  if (stored == nullptr) return;
  const auto names = separated(ml::detail::metadata_text(file.metadata(), "training.measures", ""));
  const auto rows = ml::values_of<double>(*stored);
  const std::size_t width = names.size() + 1;
  if (stored->shape.rank() != 2 || stored->shape[1] != static_cast<ml::Index>(width))
    ml::raise<ml::io_error>(403, file.name(), ": validations ", stored->shape, ", named are ", names.size());
  for (std::size_t at = 0; at < rows.size(); at += width) {
    Validation v{static_cast<ml::Index>(rows[at]), names};
    for (std::size_t i = 0; i < names.size(); ++i) v.measures[i].value = rows[at + 1 + i];
    validations.push_back(std::move(v));
  }
}

std::string TrainingRecord::curves() const {
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
  return curves_svg(panels);
}

void require_same_settings(const ml::SafetensorsFile& checkpoint, const std::map<std::string, std::string>& settings,
                           bool with_other_settings) {
  for (const auto& [name, value] : settings) {
    if (with_other_settings && name.starts_with("training.")) continue;
    const std::string before = ml::detail::metadata_text(checkpoint.metadata(), name, "nothing");
    if (value == before) continue;
    const bool is_long = value.size() + before.size() > 100;  // the vocabulary
    ml::raise<ml::config_error>(102, checkpoint.name(), ": this run began with another ", name,
                                is_long ? "" : " (" + before + ", not " + value + ")", "; --fresh starts anew, another --out keeps both");
  }
}

}  // namespace program
