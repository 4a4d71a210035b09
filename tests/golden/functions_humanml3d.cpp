// Golden functions: the features of HumanML3D and KIT, their skeletons and quaternions.
#include <motionlang/features/guoh3d.hpp>
#include <motionlang/features/guoh3d_extraction.hpp>
#include <motionlang/features/statistics.hpp>
#include <motionlang/kinematics/mirror_joints.hpp>

#include "geometry.hpp"

namespace {

using golden::Case, golden::Registration;
using golden::out_each, golden::out_list, golden::quaternions, golden::vectors, golden::view;
using golden::Quaternions, golden::Vectors;
namespace ml = motionlang;

/// Six numbers each, as matrices.
template <class S>
std::vector<ml::Matrix3<S>> six_numbers(const Case& c, const std::string& name) {
  const auto columns = vectors<S>(c, name);
  std::vector<ml::Matrix3<S>> out;
  for (std::size_t i = 0; i < columns.size(); i += 2) {
    out.push_back(to_matrix(ml::Rotation6dColumns<S>{columns[i], columns[i + 1]}));
  }
  return out;
}
ml::ChainSkeleton skeleton_of(const Case& c) {
  const auto config = c.config();
  ml::ChainSkeleton skeleton = config["dataset"].as<std::string>() == "kit" ? ml::kit_chains() : ml::humanml3d_chains();
  if (config.contains("face_joints")) {
    const auto face = config["face_joints"].as<std::vector<int>>();
    std::copy_n(face.begin(), 4, skeleton.face.begin());
  }
  skeleton.foot_threshold = config.value_or("feet_threshold", skeleton.foot_threshold);
  return skeleton;
}
ml::Guoh3dOptions options_of(const Case& c) {
  return {.rotations = {.facing = {.sigma = c.config().value_or("forward_sigma", 20.0)}}};
}
/// Bone lengths from offsets.
template <class S>
std::vector<S> lengths_of(const Vectors<S>& offsets) {
  std::vector<S> out;
  for (const auto& o : offsets) out.push_back(norm(o));
  return out;
}

template <class S>
void quaternion_algebra(Case& c) {
  const auto q = quaternions<S>(c, "q"), r = quaternions<S>(c, "r"), scaled = quaternions<S>(c, "q_scaled");
  const auto v = vectors<S>(c, "v");
  const auto n = q.size();
  out_each<S>(c, "mul", n, [&](auto i) { return q[i] * r[i]; });
  out_each<S>(c, "inv", n, [&](auto i) { return inverse(q[i]); });
  out_each<S>(c, "inv_scaled", n, [&](auto i) { return inverse(scaled[i]); });
  out_each<S>(c, "normalised", n, [&](auto i) { return normalized(scaled[i]); });
  out_each<S>(c, "rotated", n, [&](auto i) { return rotate(q[i], v[i]); });
  out_each<S>(c, "rotated_scaled", n, [&](auto i) { return rotate(scaled[i], v[i]); });
  out_each<S>(c, "matrix", n, [&](auto i) { return to_matrix(scaled[i]); });
  out_each<S>(c, "cont6d", n, [&](auto i) { return ml::to_rotation6d_columns(q[i]); });
  out_list<S>(c, "matrix_from_cont6d", six_numbers<S>(c, "cont6d"));
  const auto rotations = six_numbers<S>(c, "cont6d_rotations");
  out_each<S>(c, "quat_from_cont6d", rotations.size(),
              [&](auto i) { return ml::guo::matrix_to_quaternion(rotations[i]); });
}

template <class S>
void quaternion_between(Case& c) {
  const auto a = vectors<S>(c, "v0"), b = vectors<S>(c, "v1");
  out_each<S>(c, "quat", a.size(), [&](auto i) { return ml::guo::between(a[i], b[i]); });
}

template <class S>
void quaternion_continuity(Case& c) {
  const auto q = quaternions<S>(c, "q");
  out_list<S>(c, "quat", ml::guo::continuous(view(q), c.shape("in/q")[1]));
}

template <class S>
void quaternion_slerp(Case& c) {
  const auto a = quaternions<S>(c, "q0"), b = quaternions<S>(c, "q1");
  const auto t = c.values<S>("in/t");
  out_each<S>(c, "quat", t.size() * a.size(), [&](auto i) {
    const auto k = i % a.size();
    return ml::guo::slerp(a[k], b[k], t[i / a.size()]);
  });
}

template <class S>
void quaternion_euler(Case& c) {
  const auto q = quaternions<S>(c, "q");
  const auto degrees = vectors<S>(c, "euler_degrees"), rotation_vectors = vectors<S>(c, "expmap");
  const S degree = S(std::numbers::pi / 180);
  auto angles = [&](auto i, ml::EulerOrder order, S unit) {
    const auto e = ml::to_euler(q[i], order);
    return ml::Vec3<S>{e.a / unit, e.b / unit, e.c / unit};
  };
  for (const auto& letters : c.config()["orders"].as<std::vector<std::string>>()) {
    const auto order = ml::EulerOrder::parse(letters);
    out_each<S>(c, "euler_" + letters, q.size(), [&](auto i) { return angles(i, order, degree); });
    out_each<S>(c, "euler_" + letters + "_xyz_columns", q.size(), [&](auto i) {
      const auto a = angles(i, order, degree);
      std::array<S, 3> columns{};
      for (const auto& [axis, value] : {std::pair{order.axis[0], a.x}, {order.axis[1], a.y}, {order.axis[2], a.z}}) {
        columns[static_cast<std::size_t>(axis)] = value;
      }
      return ml::Vec3<S>{columns[0], columns[1], columns[2]};
    });
    out_each<S>(c, "quat_" + letters, degrees.size(),
                [&](auto i) { return ml::guo::from_euler_degrees(degrees[i], order); });
  }
  out_each<S>(c, "euler_radians_zyx", q.size(), [&](auto i) { return angles(i, ml::EulerOrder::parse("zyx"), S(1)); });
  out_each<S>(c, "quat_expmap", rotation_vectors.size(),
              [&](auto i) { return to_quaternion(ml::AxisAngle<S>{rotation_vectors[i]}); });
}

template <class S>
void skeleton_offsets(Case& c) {
  const auto skeleton = skeleton_of(c);
  const auto joints = vectors<S>(c, "joints");
  const std::size_t n = skeleton.size();
  Vectors<S> per_frame;
  for (std::size_t at = 0; at < joints.size(); at += n) {
    const auto lengths = ml::bone_lengths(skeleton, view(joints).subspan(at, n));
    const auto offsets = ml::chain_offsets<S>(skeleton, view(lengths));
    per_frame.insert(per_frame.end(), offsets.begin(), offsets.end());
  }
  out_list<S>(c, "offsets_per_frame", per_frame);
  per_frame.resize(n);
  out_list<S>(c, "offsets_first_frame", per_frame);
  c.out("parents", skeleton.parents());
}

template <class S>
void inverse_kinematics(Case& c) {
  const auto skeleton = skeleton_of(c);
  const auto joints = vectors<S>(c, "joints");
  const auto smooth = options_of(c).rotations;
  out_list<S>(c, "quat", ml::chain_inverse_kinematics(skeleton, view(joints)));
  out_list<S>(c, "quat_smooth", ml::chain_inverse_kinematics(skeleton, view(joints), smooth));
  out_list<S>(c, "forward", ml::facing_directions(skeleton, view(joints)));
  out_list<S>(c, "forward_smooth", ml::facing_directions(skeleton, view(joints), smooth.facing));
}

template <class S>
void forward_kinematics(Case& c) {
  const auto skeleton = skeleton_of(c);
  const auto q = quaternions<S>(c, "quat");
  const auto matrices = six_numbers<S>(c, "cont6d");
  const auto root = vectors<S>(c, "root"), offsets = vectors<S>(c, "offsets"),
             bodies = vectors<S>(c, "skeleton_joints");
  auto out = [&](const std::string& name, const auto& local, const Vectors<S>& bones, bool root_rotation) {
    out_list<S>(c, name, ml::chain_forward_kinematics(skeleton, view(local), view(root), view(bones), root_rotation));
  };
  out("joints", q, offsets, true);
  out("joints_no_root", q, offsets, false);
  out("joints_cont6d", matrices, offsets, true);
  out("joints_cont6d_no_root", matrices, offsets, false);
  Vectors<S> per_frame;
  for (std::size_t at = 0; at < bodies.size(); at += skeleton.size()) {
    const auto lengths = ml::bone_lengths(skeleton, view(bodies).subspan(at, skeleton.size()));
    for (const auto& offset : ml::chain_offsets<S>(skeleton, view(lengths))) per_frame.push_back(offset);
  }
  out("joints_skeleton_per_frame", q, per_frame, true);
}

template <class S>
void uniform_skeleton(Case& c) {
  const auto joints = vectors<S>(c, "joints");
  const auto lengths = lengths_of(vectors<S>(c, "target_offsets"));
  const auto result = ml::uniform_skeleton(skeleton_of(c), view(joints), view(lengths));
  out_list<S>(c, "positions", result.joints);
  c.out_scalar("scale_ratio", result.scale);
}

template <class S>
void features_from_joints(Case& c) {
  const auto skeleton = skeleton_of(c);
  const auto options = options_of(c);
  const auto joints = vectors<S>(c, "joints");
  const auto lengths = lengths_of(vectors<S>(c, "target_offsets"));
  const std::size_t n = skeleton.size(), frames = joints.size() / n;

  const auto source = ml::bone_lengths(skeleton, view(joints).first(n));
  out_list<S>(c, "src_offsets", ml::chain_offsets<S>(skeleton, view(source)));
  out_list<S>(c, "ik_quat_nosmooth", ml::chain_inverse_kinematics(skeleton, view(joints)));
  const auto uniform = ml::uniform_skeleton(skeleton, view(joints), view(lengths));
  c.out_scalar("scale_ratio", uniform.scale);
  out_list<S>(c, "uniform_positions", uniform.joints);
  const auto grounded = ml::ground_joints(skeleton, view(uniform.joints));
  c.out_scalar("floor_height", grounded.floor);
  out_list<S>(c, "init_quat", Quaternions<S>{grounded.turn});
  const auto& global = grounded.joints;
  out_list<S>(c, "global_positions", global);

  out_list<S>(c, "forward_smoothed", ml::facing_directions(skeleton, view(global), options.rotations.facing));
  const auto q = ml::chain_inverse_kinematics(skeleton, view(global), options.rotations);
  out_list<S>(c, "ik_quat_smooth", q);
  out_each<S>(c, "cont6d", q.size(), [&](auto i) { return ml::to_rotation6d_columns(q[i]); });
  out_each<S>(c, "root_quat_velocity", frames - 1, [&](auto t) { return ml::guoh3d_turn(q[t * n], q[(t + 1) * n]); });
  out_each<S>(c, "lin_vel_local", frames - 1,
              [&](auto t) { return ml::guoh3d_root_velocity(q[(t + 1) * n], global[t * n], global[(t + 1) * n]); });
  out_each<S>(c, "ric_positions", joints.size(), [&](auto i) {
    const auto root = i - i % n;
    return ml::guoh3d_position(q[root], global[root], global[i]);
  });
  const auto left = ml::guoh3d_contacts(skeleton, view(global), skeleton.left_foot);
  const auto right = ml::guoh3d_contacts(skeleton, view(global), skeleton.right_foot);
  c.out("contacts_left", c.shape("out/contacts_left"), left);
  c.out("contacts_right", c.shape("out/contacts_right"), right);
  c.out("features", c.shape("out/features"), ml::guoh3d_features(skeleton, view(joints), view(lengths), options));
}

template <class S>
void features_from_global(Case& c) {
  const auto joints = vectors<S>(c, "joints");
  c.out("features", c.shape("out/features"), ml::guoh3d_from_grounded(skeleton_of(c), view(joints), options_of(c)));
}

template <class S>
void contacts(Case& c) {
  const auto skeleton = skeleton_of(c);
  const auto joints = vectors<S>(c, "joints");
  c.out("left", c.shape("out/left"), ml::guoh3d_contacts(skeleton, view(joints), skeleton.left_foot));
  c.out("right", c.shape("out/right"), ml::guoh3d_contacts(skeleton, view(joints), skeleton.right_foot));
}

template <class S>
void recovery(Case& c) {
  const auto skeleton = skeleton_of(c);
  const auto features = c.values<S>("in/features");
  const auto offsets = vectors<S>(c, "offsets");
  const auto joints = static_cast<ml::Index>(skeleton.size());
  const auto root = ml::guoh3d_root(view(features), joints);
  out_list<S>(c, "root_quat", root.turn);
  out_list<S>(c, "root_pos", root.position);
  out_list<S>(c, "joints_from_ric", ml::guoh3d_joints(view(features), joints));
  out_list<S>(c, "joints_from_rot", ml::guoh3d_joints_from_rotations(skeleton, view(features), view(offsets)));
}

template <class S>
void mirroring(Case& c) {
  for (const auto& name : c.names("in/")) {
    const auto partners = ml::humanml3d_mirror_partners(static_cast<int>(c.shape("in/" + name)[1]));
    out_list<S>(c, name, ml::mirror_joints(view(vectors<S>(c, name)), view(partners)));
  }
}

template <class S>
void feature_statistics(Case& c) {
  const ml::Guoh3dSlots slots{static_cast<ml::Index>(skeleton_of(c).size())};
  ml::FeatureStatistics statistics;
  for (const auto& clip : c.names("in/")) statistics.add_finite(view(c.values<S>("in/" + clip)), slots.size());
  const auto deviation = statistics.population_deviation();
  c.out("mean", statistics.mean());
  c.out("std_raw", deviation);
  c.out("std_grouped", ml::group_means(deviation, slots.groups()));
}

const Registration registrations[] = {
    {"guo quaternion algebra", "double", quaternion_algebra<double>},
    {"guo quaternion algebra", "float", quaternion_algebra<float>},
    {"guo quaternion between vectors", "double", quaternion_between<double>},
    {"guo quaternion between vectors", "float", quaternion_between<float>},
    {"guo quaternion continuity", "double", quaternion_continuity<double>},
    {"guo quaternion continuity", "float", quaternion_continuity<float>},
    {"guo quaternion slerp", "double", quaternion_slerp<double>},
    {"guo quaternion slerp", "float", quaternion_slerp<float>},
    {"guo quaternion and euler angles", "double", quaternion_euler<double>},
    {"guo quaternion and euler angles", "float", quaternion_euler<float>},
    {"guo skeleton offsets", "double", skeleton_offsets<double>},
    {"guo skeleton offsets", "float", skeleton_offsets<float>},
    {"guo inverse kinematics", "double", inverse_kinematics<double>},
    {"guo inverse kinematics", "float", inverse_kinematics<float>},
    {"guo forward kinematics", "double", forward_kinematics<double>},
    {"guo forward kinematics", "float", forward_kinematics<float>},
    {"guo uniform skeleton", "double", uniform_skeleton<double>},
    {"guo uniform skeleton", "float", uniform_skeleton<float>},
    {"guo features from joints", "double", features_from_joints<double>},
    {"guo features from joints", "float", features_from_joints<float>},
    {"guo features from global positions", "double", features_from_global<double>},
    {"guo features from global positions", "float", features_from_global<float>},
    {"guo foot contacts", "double", contacts<double>},
    {"guo foot contacts", "float", contacts<float>},
    {"guo recovery", "double", recovery<double>},
    {"guo recovery", "float", recovery<float>},
    {"humanml3d mirroring", "double", mirroring<double>},
    {"humanml3d mirroring", "float", mirroring<float>},
    {"guo feature statistics", "double", feature_statistics<double>},
    {"guo feature statistics", "float", feature_statistics<float>},
};

}  // namespace
