// Golden functions: what TM2T's tokenizer is trained on, and how its motions are shown.
#include <motionlang/datasets/tm2t_data.hpp>
#include <motionlang/kinematics/gaussian_smooth.hpp>

#include "golden.hpp"

namespace {

using golden::Case, golden::Registration;
namespace ml = motionlang;
using ml::Index;

template <class S>
void meta_statistics(Case& c) {
  const auto std = c.values<S>("in/std");
  const Index joints = c.config()["joints"].as<Index>();
  const double bias = c.config()["feat_bias"].as<double>();
  c.out("std_after_train_set", ml::tm2t_deviation(std, joints, bias, 1));
  c.out("std_meta", ml::tm2t_deviation(std, joints, bias));
}

void window_index(Case& c) {
  std::vector<Index> flat;
  for (const auto& w : ml::tm2t_windows(c.values<Index>("in/lengths"), c.config()["window"].as<Index>()))
    flat.insert(flat.end(), {w.clip, w.start});
  c.out("clip_and_start", {std::ssize(flat) / 2, 2}, flat);
}

template <class S>
void display_filter(Case& c) {
  const auto joints = c.values<S>("in/joints");
  const auto shape = c.shape("in/joints");
  c.out(
      "joints", shape,
      ml::gaussian_smooth(std::span<const S>(joints), shape.count(1, shape.rank()), c.config()["sigma"].as<double>()));
}

void teacher_forcing(Case& c) {
  const ml::TeacherForcing schedule{.first = c.config()["start"].as<double>(),
                                    .last = c.config()["end"].as<double>(),
                                    .epochs = c.config()["end_epoch"].as<Index>()};
  std::vector<double> ratio;
  for (const Index epoch : c.values<Index>("in/epochs")) ratio.push_back(schedule(epoch));
  c.out("ratio", ratio);
}

const Registration statistics64{"tm2t meta statistics", "double", meta_statistics<double>};
const Registration statistics32{"tm2t meta statistics", "float", meta_statistics<float>};
const Registration windows{"tm2t window index", "double", window_index};
const Registration filter64{"tm2t display filter", "double", display_filter<double>};
const Registration filter32{"tm2t display filter", "float", display_filter<float>};
const Registration forcing{"tm2t teacher forcing schedule", "double", teacher_forcing};

}  // namespace
