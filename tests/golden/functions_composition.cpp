// Golden functions: motions put together in space (SINC) and in time (TEACH).
#include <motionlang/compose/sinc_composition.hpp>
#include <motionlang/compose/teach_join.hpp>
#include <motionlang/kinematics/sinc_part_motion.hpp>

#include "geometry.hpp"
#include "part_vectors.hpp"

namespace {

using golden::Case, golden::Registration;
using golden::matrices, golden::out_list, golden::part_vectors, golden::vectors, golden::view;
namespace ml = motionlang;

template <class S>
void sinc_composition(Case& c) {
  const ml::SmplVelpMotion<S> a{matrices<S>(c, "rots_1"), vectors<S>(c, "trans_1")},
      b{matrices<S>(c, "rots_2"), vectors<S>(c, "trans_2")};
  const auto parts_a = part_vectors(c, "parts_1"), parts_b = part_vectors(c, "parts_2");
  for (std::size_t i = 0; i < parts_a.size(); ++i) {
    const std::string number = std::to_string(i);
    for (const auto& [suffix, trim] : {std::pair("_start", ml::SincTrim::end), {"_center", ml::SincTrim::both_ends}}) {
      const auto motion = ml::compose_motions(a, parts_a[i], b, parts_b[i], trim);
      out_list<S>(c, "rots_" + number + suffix, motion.rotations);
      out_list<S>(c, "trans_" + number + suffix, motion.trans);
      const std::string features = "features_" + number + suffix;
      if (c.wants(features)) {
        c.out(features, c.shape("out/" + features), ml::smplvelp_features(view(motion.rotations), view(motion.trans)));
      }
    }
  }
}

/// Composed items go through rotations and back; of the others the first frames are taken.
template <class S>
void sinc_mixed_batch(Case& c) {
  const auto mean = c.values<S>("in/mean"), deviation = c.values<S>("in/std");
  const S eps = c.config()["eps"].as<S>();
  const auto parts_a = part_vectors(c, "parts_a"), parts_b = part_vectors(c, "parts_b");
  const auto synthetic = c.values<ml::Index>("in/synthetic");
  const std::size_t width = mean.size();
  const auto motion = [&](const std::string& name) {
    auto x = c.values<S>("in/" + name);
    for (std::size_t i = 0; i < x.size(); ++i) x[i] = x[i] * (deviation[i % width] + eps) + mean[i % width];
    return ml::smplvelp_inverse(view(x));
  };
  std::vector<std::vector<S>> items;
  std::vector<ml::Index> lengths;
  for (std::size_t k = 0; k < synthetic.size(); ++k) {
    const std::string a = "features_a_" + std::to_string(k), b = "features_b_" + std::to_string(k);
    std::vector<S> x;
    if (synthetic[k] != 0) {
      const auto both = ml::compose_motions(motion(a), parts_a[k], motion(b), parts_b[k]);
      x = ml::smplvelp_features(view(both.rotations), view(both.trans));
      for (std::size_t i = 0; i < x.size(); ++i) x[i] = (x[i] - mean[i % width]) / (deviation[i % width] + eps);
    } else {
      x = c.values<S>("in/" + a);
      x.resize(std::min(x.size(), c.config()["window"].as<std::size_t>() * width));
    }
    lengths.push_back(std::ssize(x) / std::ssize(mean));
    items.push_back(std::move(x));
  }
  const auto longest = static_cast<std::size_t>(*std::max_element(lengths.begin(), lengths.end()));
  std::vector<S> padded;
  for (auto& x : items) {
    x.resize(longest * width);
    padded.insert(padded.end(), x.begin(), x.end());
  }
  c.out("lengths", lengths);
  c.out("features", {std::ssize(items), static_cast<ml::Index>(longest), std::ssize(mean)}, padded);
}

template <class S>
void teach_alignment(Case& c) {
  const auto last = matrices<S>(c, "rots_last");
  const ml::PoseInWorld<S> e{last, vectors<S>(c, "trans_last").at(0)};
  auto rotations = matrices<S>(c, "rots"), same = rotations;
  auto trans = vectors<S>(c, "trans"), moved = trans;
  ml::align_to<S>(e, rotations, trans);
  ml::align_to<S>(e, same, moved, ml::Alignment::translation);
  out_list<S>(c, "rots", rotations);
  out_list<S>(c, "trans", trans);
  out_list<S>(c, "trans_translation_only", moved);
}

template <class S>
void teach_slerp_window(Case& c) {
  const auto last = matrices<S>(c, "rots_last"), next = matrices<S>(c, "rots_next");
  const auto window =
      ml::slerp_window<S>({last, vectors<S>(c, "trans_last").at(0)}, {next, vectors<S>(c, "trans_next").at(0)},
                          c.config()["window"].as<ml::Index>());
  out_list<S>(c, "rots", window.rotations);
  out_list<S>(c, "trans", window.trans);
}

template <class S>
void sinc_part_labels_from_motion(Case& c) {
  std::vector<S> velocity;
  std::vector<ml::Index> active;
  for (std::size_t k = 0; c.has("in/joints_" + std::to_string(k)); ++k) {
    const auto speeds = ml::sinc_part_speeds(view(vectors<S>(c, "joints_" + std::to_string(k))));
    velocity.insert(velocity.end(), speeds.begin(), speeds.end());
    const auto moving = ml::moving_sinc_parts(speeds, c.config()["threshold"].as<double>());
    for (std::size_t p = 0; p < moving.size(); ++p) active.push_back(moving[p]);
  }
  c.out("velocity", c.shape("out/velocity"), velocity);
  c.out("active", c.shape("out/active"), active);
}

const Registration registrations[] = {
    {"sinc composition", "double", sinc_composition<double>},
    {"sinc composition", "float", sinc_composition<float>},
    {"sinc mixed batch", "double", sinc_mixed_batch<double>},
    {"sinc mixed batch", "float", sinc_mixed_batch<float>},
    {"sinc part labels from joint motion", "double", sinc_part_labels_from_motion<double>},
    {"sinc part labels from joint motion", "float", sinc_part_labels_from_motion<float>},
    {"teach alignment", "double", teach_alignment<double>},
    {"teach alignment", "float", teach_alignment<float>},
    {"teach slerp window", "double", teach_slerp_window<double>},
    {"teach slerp window", "float", teach_slerp_window<float>},
};

}  // namespace
