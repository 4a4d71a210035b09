// Golden functions: the representations of ACTOR, TEMOS, TEACH, SINC and TMR, and which frames they take.
#include <motionlang/features/frame_sampling.hpp>
#include <motionlang/features/guoh3d.hpp>
#include <motionlang/features/joint_sets.hpp>
#include <motionlang/features/pose_representation.hpp>
#include <motionlang/features/rifke.hpp>
#include <motionlang/features/smplvelp.hpp>

#include "geometry.hpp"
#include "seeds.hpp"

namespace {

using golden::append, golden::matrices, golden::out_each, golden::out_list, golden::vectors, golden::view;
using golden::Case, golden::Registration;
namespace ml = motionlang;

/// Statistics of a case, if it normalises: there (x - m) / (s + eps), back x (s + eps) + m.
template <class S>
struct Normalisation {
  std::vector<S> mean, deviation;
  S eps, eps_back;

  Normalisation(const Case& c, S small, S small_back) : eps(small), eps_back(small_back) {
    if (!c.config().value_or("normalization", true)) return;
    mean = c.values<S>("in/mean"), deviation = c.values<S>("in/std");
  }
  std::vector<S> there(std::vector<S> x) const {
    for (std::size_t i = 0; i < x.size() && !mean.empty(); ++i) {
      const auto k = i % mean.size();
      x[i] = (x[i] - mean[k]) / (deviation[k] + eps);
    }
    return x;
  }
  std::vector<S> back(std::vector<S> x) const {
    for (std::size_t i = 0; i < x.size() && !mean.empty(); ++i) {
      const auto k = i % mean.size();
      x[i] = x[i] * (deviation[k] + eps_back) + mean[k];
    }
    return x;
  }
};

/// Calls f(the sequence) for each sequence (frames, width...) of a tensor with or without a batch axis.
template <class T, class F>
void for_each_sequence(const std::vector<T>& values, const ml::Shape& shape, int rank, F f) {
  const auto batch = static_cast<std::size_t>(shape.rank() > rank ? shape[0] : 1);
  for (std::size_t b = 0; b < batch; ++b) f(view(values).subspan(b * values.size() / batch, values.size() / batch));
}
template <class T>
void extend(std::vector<T>& out, const std::vector<T>& more) {
  out.insert(out.end(), more.begin(), more.end());
}

template <class S>
void temos_rifke_features(Case& c) {
  const auto variant = ml::temos_rifke();
  const Normalisation<S> normalisation(c, S(1e-12), S(0));
  const bool filter = c.config().value_or("forward_filter", false);
  std::vector<S> features, floor, forward, angles;
  std::vector<ml::Vec3<S>> joints;
  for_each_sequence(vectors<S>(c, "joints"), c.shape("in/joints"), 3, [&](auto sequence) {
    const auto result = ml::rifke_features(variant, sequence, filter);
    const auto normal = normalisation.there(result.features);
    extend(features, normal);
    extend(joints, ml::rifke_joints(variant, view(normalisation.back(normal))));
    floor.push_back(result.floor);
    for (const auto& f : result.forward) forward.insert(forward.end(), f.begin(), f.end());
    extend(angles, result.angles);
  });
  c.out("features", c.shape("out/features"), features);
  c.out("floor", c.shape("out/floor"), floor);
  c.out("forward", c.shape("out/forward"), forward);
  c.out("angles", c.shape("out/angles"), angles);
  out_list<S>(c, "joints", joints);
}

template <class S>
void temos_rifke_inverse(Case& c) {
  const Normalisation<S> normalisation(c, S(1e-12), S(0));
  std::vector<ml::Vec3<S>> joints;
  for_each_sequence(normalisation.back(c.values<S>("in/features")), c.shape("in/features"), 2,
                    [&](auto sequence) { extend(joints, ml::rifke_joints(ml::temos_rifke(), sequence)); });
  out_list<S>(c, "joints", joints);
}

template <class S>
void sinc_rifke(Case& c) {
  const auto variant = ml::sinc_rifke();
  const auto features = ml::rifke_features(variant, view(vectors<S>(c, "joints"))).features;
  const auto joints = ml::rifke_joints(variant, view(features));
  const auto n = static_cast<std::size_t>(variant.joints), width = static_cast<std::size_t>(variant.size());
  c.out("features", c.shape("out/features"), features);
  out_list<S>(c, "joints", joints);
  out_list<S>(c, "joints_back", joints);
  std::vector<S> local, trajectory;
  for (std::size_t at = 0; at < features.size(); at += width) {
    local.insert(local.end(), &features[at + 1], &features[at + width - 3]);
  }
  c.out("local", c.shape("out/local"), local);
  out_each<S>(c, "root", joints.size() / n, [&](auto t) { return joints[t * n]; });
  for (std::size_t i = 0; i < joints.size(); i += n) trajectory.insert(trajectory.end(), {joints[i].x, joints[i].y});
  c.out("trajectory", c.shape("out/trajectory"), trajectory);
}

ml::RifkeVariant tmr_variant(const Case& c) {
  return ml::tmr_rifke(c.config()["jointstype"].as<std::string>() == "smpljoints" ? 24 : 22);
}
template <class S>
void tmr_rifke_features(Case& c) {
  const auto result = ml::rifke_features(tmr_variant(c), view(vectors<S>(c, "joints")));
  std::vector<S> forward;
  for (const auto& f : result.forward) forward.insert(forward.end(), f.begin(), f.end());
  c.out("features", c.shape("out/features"), result.features);
  c.out("forward", c.shape("out/forward"), forward);
  out_list<S>(c, "joints", ml::rifke_joints(tmr_variant(c), view(result.features)));
}
template <class S>
void tmr_rifke_inverse(Case& c) {
  out_list<S>(c, "joints", ml::rifke_joints(tmr_variant(c), view(c.values<S>("in/features"))));
}
template <class S>
void tmr_features_to_joints(Case& c) {
  auto joints = ml::guoh3d_joints(view(c.values<S>("in/features")), c.config().value_or("joints", 22));
  for (auto& p : joints) p = {p.x, -p.z, p.y};
  out_list<S>(c, "joints", joints);
}

ml::PoseRepresentation representation(const Case& c) {
  return ml::parse_pose_representation(c.config().value_or("pose_rep", "rot6d"));
}
template <class S>
void out_motion(Case& c, const std::string& rotations, const std::string& trans, const ml::SmplVelpMotion<S>& motion) {
  out_list<S>(c, rotations, motion.rotations);
  if (c.wants(trans)) out_list<S>(c, trans, motion.trans);
}

template <class S>
void temos_smplvelp_features(Case& c) {
  const auto config = c.config();
  const Normalisation<S> normalisation(c, S(1e-12), S(0));
  const auto rotations = matrices<S>(c, "rotations");
  const auto trans = vectors<S>(c, "translation");
  const auto joints = c.shape("in/rotations")[1];
  const auto features =
      normalisation.there(ml::smplvelp_features(view(rotations), view(trans),
                                                {.rotations = representation(c),
                                                 .canonicalize = config.value_or("canonicalize", true),
                                                 .offset = config.value_or("offset", true)}));
  c.out("features", c.shape("out/features"), features);
  out_motion<S>(c, "inverse_rotations", "inverse_translation",
                ml::smplvelp_inverse(view(normalisation.back(features)), joints, representation(c)));
}
template <class S>
void temos_smplvelp_inverse(Case& c) {
  const Normalisation<S> normalisation(c, S(1e-12), S(0));
  ml::SmplVelpMotion<S> all;
  const ml::Shape& shape = c.shape("in/features");
  const auto joints = (shape[shape.rank() - 1] - 3) / ml::size(representation(c));
  for_each_sequence(normalisation.back(c.values<S>("in/features")), shape, 2, [&](auto sequence) {
    const auto motion = ml::smplvelp_inverse(sequence, joints, representation(c));
    extend(all.rotations, motion.rotations), extend(all.trans, motion.trans);
  });
  out_motion(c, "rotations", "translation", all);
}

template <class S>
std::vector<S> velp(const ml::SmplVelpMotion<S>& motion, const ml::SmplVelpOptions& options = {}) {
  return ml::smplvelp_features(view(motion.rotations), view(motion.trans), options);
}
template <class S>
void teach_features(Case& c) {
  const Normalisation<S> normalisation(c, S(1e-12), S(0));
  const ml::SmplVelpMotion<S> motion{matrices<S>(c, "rots"), vectors<S>(c, "trans")};
  const auto joints = c.shape("in/rots")[1];
  const auto raw = velp(motion);
  auto out = [&](const std::string& name, const std::vector<S>& values) {
    c.out(name, c.shape("out/" + name), values);
  };
  out("features_raw", raw);
  out("features", normalisation.there(raw));
  const auto back = ml::smplvelp_inverse(view(raw), joints);
  out_motion(c, "rots_back", "trans_back", back);
  const auto second = velp(back);
  out("features_pass2", second);
  out("features_pass3", velp(ml::smplvelp_inverse(view(second), joints)));
  out("features_not_canonical", velp(motion, {.canonicalize = false}));
  out("features_no_offset", velp(motion, {.offset = false}));
  const auto given = normalisation.back(c.values<S>("in/features"));
  out_motion(c, "rots_of_features", "trans_of_features", ml::smplvelp_inverse(view(given), joints));
}
template <class S>
void sinc_features(Case& c) {
  const Normalisation<S> normalisation(c, S(1e-5), S(1e-5));
  const ml::SmplVelpMotion<S> motion{matrices<S>(c, "rots"), vectors<S>(c, "trans")};
  const auto joints = c.shape("in/rots")[1];
  const auto features = normalisation.there(velp(motion));
  c.out("features", c.shape("out/features"), features);
  const auto back = ml::smplvelp_inverse(view(normalisation.back(features)), joints);
  out_motion(c, "rots_back", "trans_back", back);
  c.out("features_rebuilt", c.shape("out/features_rebuilt"), normalisation.there(velp(back)));
  const auto given = normalisation.back(c.values<S>("in/features"));
  out_motion(c, "rots_of_features", "trans_of_features", ml::smplvelp_inverse(view(given), joints));
}

/// In double only: rotation vectors that go through matrices in float lose half of their digits.
void teach_rotation_conversions(Case& c) {
  using S = double;
  namespace p3d = ml::pytorch3d;
  const auto axis_angle = vectors<S>(c, "axis_angle"), six = vectors<S>(c, "rot6d");
  const auto given = matrices<S>(c, "matrix");
  const auto n = axis_angle.size();
  auto matrix = [&](auto i) { return to_matrix(ml::AxisAngle<S>{axis_angle[i]}); };
  out_each<S>(c, "quat", n, [&](auto i) { return to_quaternion(ml::AxisAngle<S>{axis_angle[i]}); });
  out_each<S>(c, "matrix", n, matrix);
  out_each<S>(c, "axis_angle_round_trip", n, [&](auto i) { return p3d::matrix_to_axis_angle(matrix(i)); });
  out_each<S>(c, "quat_of_matrix", given.size(), [&](auto i) { return p3d::matrix_to_quaternion(given[i]); });
  out_each<S>(c, "axis_angle_of_matrix", given.size(), [&](auto i) { return p3d::matrix_to_axis_angle(given[i]); });
  out_each<S>(c, "rot6d_of_matrix", given.size(), [&](auto i) { return ml::to_rotation6d_rows(given[i]); });
  out_each<S>(c, "matrix_of_rot6d", six.size() / 2, [&](auto i) {
    return to_matrix(ml::Rotation6dRows<S>{six[2 * i], six[2 * i + 1]});
  });
}

void actor_motion_features(Case& c) {
  using S = double;
  const auto config = c.config();
  const auto positions = vectors<S>(c, "joints3d");
  const auto joints = c.shape("in/joints3d")[1];
  if (config["pose_rep"].as<std::string>() == "xyz") {
    return c.out("x", c.shape("out/x"), ml::actor_joint_features(view(positions), joints));
  }
  std::vector<ml::AxisAngle<S>> poses;
  for (const auto& v : vectors<S>(c, "poses")) poses.push_back({v});
  std::vector<ml::Vec3<S>> root;
  for (std::size_t i = 0; i < positions.size(); i += static_cast<std::size_t>(joints)) root.push_back(positions[i]);
  c.out("x", c.shape("out/x"),
        ml::actor_features(view(poses), view(root), c.shape("in/poses")[1],
                           {.rotations = representation(c),
                            .translation = config["translation"].as<bool>(),
                            .global = config["glob"].as<bool>()}));
}

void temos_subsampling(Case& c) {
  const auto old_fps = c.values<double>("in/framerate"), new_fps = c.values<double>("in/new_framerate");
  const auto frames = c.values<ml::Index>("in/num_frames");
  for (std::size_t k = 0; k < frames.size(); ++k) {
    c.out(golden::three_digits(static_cast<ml::Index>(k)), ml::every_nth_frame(frames[k], old_fps[k], new_fps[k]));
  }
}
template <class S>
void temos_upsampling(Case& c) {
  const ml::Shape& shape = c.shape("in/motion");
  c.out("motion", c.shape("out/motion"),
        ml::upsample_linearly(view(c.values<S>("in/motion")), shape.count(1, shape.rank()),
                              c.config()["framerate"].as<double>(), c.config()["new_framerate"].as<double>()));
}

void tmr_motion_slice(Case& c) {
  const auto start = c.values<double>("in/start"), end = c.values<double>("in/end");
  std::vector<ml::Index> out;
  for (std::size_t k = 0; k < start.size(); ++k) {
    const auto slice =
        ml::slice_of_seconds(start[k], end[k], c.config()["fps"].as<double>(), c.scalar<ml::Index>("in/num_frames"));
    out.insert(out.end(), {slice.first, slice.length});
  }
  c.out("first_and_length", c.shape("out/first_and_length"), out);
}

void actor_frame_selection(Case& c) {
  const auto config = c.config();
  auto random = golden::seeded<ml::PythonRandom>(config["seed"]);
  std::vector<ml::Index> out;
  for (const ml::Index available : c.values<ml::Index>("in/available")) {
    extend(out, ml::actor_frames(available,
                                 {.frames = config["num_frames"].as<ml::Index>(),
                                  .random_step = config["sampling"].as<std::string>() == "random_conseq",
                                  .step = config["sampling_step"].as<ml::Index>()},
                                 random));
  }
  c.out("indices", c.shape("out/indices"), out);
}

template <class S>
void teach_joint_sets(Case& c) {
  const auto points = vectors<S>(c, "joints"), trans = vectors<S>(c, "trans");
  for (const auto& name : c.names("out/")) out_list<S>(c, name, ml::select_joints(name, view(points), view(trans)));
}

const Registration registrations[] = {
    {"temos rifke features", "double", temos_rifke_features<double>},
    {"temos rifke features", "float", temos_rifke_features<float>},
    {"temos rifke inverse", "double", temos_rifke_inverse<double>},
    {"temos rifke inverse", "float", temos_rifke_inverse<float>},
    {"sinc z-up rifke", "double", sinc_rifke<double>},
    {"sinc z-up rifke", "float", sinc_rifke<float>},
    {"tmr rifke features", "double", tmr_rifke_features<double>},
    {"tmr rifke features", "float", tmr_rifke_features<float>},
    {"tmr rifke inverse", "double", tmr_rifke_inverse<double>},
    {"tmr rifke inverse", "float", tmr_rifke_inverse<float>},
    {"tmr features to joints", "double", tmr_features_to_joints<double>},
    {"tmr features to joints", "float", tmr_features_to_joints<float>},
    {"temos smplvelp features", "double", temos_smplvelp_features<double>},
    {"temos smplvelp features", "float", temos_smplvelp_features<float>},
    {"temos smplvelp inverse", "double", temos_smplvelp_inverse<double>},
    {"temos smplvelp inverse", "float", temos_smplvelp_inverse<float>},
    {"teach features", "double", teach_features<double>},
    {"teach features", "float", teach_features<float>},
    {"sinc features", "double", sinc_features<double>},
    {"sinc features", "float", sinc_features<float>},
    {"teach rotation conversions", "double", teach_rotation_conversions},
    {"actor motion features", "double", actor_motion_features},
    {"actor frame selection", "integers", actor_frame_selection},
    {"temos subsampling", "integers", temos_subsampling},
    {"temos upsampling", "double", temos_upsampling<double>},
    {"temos upsampling", "float", temos_upsampling<float>},
    {"tmr motion slice", "integers", tmr_motion_slice},
    {"teach joint sets", "double", teach_joint_sets<double>},
    {"teach joint sets", "float", teach_joint_sets<float>},
};

}  // namespace
