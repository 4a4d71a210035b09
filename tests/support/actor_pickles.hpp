// SPDX-License-Identifier: MIT
/// The bytes of pickles as the data sets of ACTOR have them: arrays of NumPy and of joblib, lists and dictionaries.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <motionlang/datasets/action_recordings.hpp>
#include <motionlang/file/file.hpp>

namespace actor_pickles {

inline std::string number(std::int64_t n) {
  const auto value = static_cast<std::int32_t>(n);
  std::string out(5, 'J');
  std::memcpy(out.data() + 1, &value, 4);
  return out;
}
inline std::string text(const std::string& s) { return std::string("U") + static_cast<char>(s.size()) + s; }

inline std::string element_type() {
  return "cnumpy\ndtype\n(U\x02"
         "f8tR(K\x03U\x01<tb";
}

inline std::string shape_of(std::span<const motionlang::Index> shape) {
  std::string out = "(";
  for (const auto n : shape) out += number(n);
  return out + "t";
}
inline std::string raw(std::span<const double> values) {
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

/// An array of NumPy; the values of a Fortran array are in its order.
inline std::string array(std::span<const double> values, std::vector<motionlang::Index> shape, bool fortran = false) {
  const std::string bytes = raw(values);
  return "cnumpy.core.multiarray\n_reconstruct\n(cnumpy\nndarray\n(" + number(0) +
         "tU\x01"
         "btR(K\x01" +
         shape_of(shape) + element_type() + (fortran ? "\x88" : "\x89") + "B" +
         number(static_cast<std::int64_t>(bytes.size())).substr(1) + bytes + "tb";
}
/// The same by joblib, behind whose wrapper the bytes lie.
inline std::string joblib_array(std::span<const double> values, std::vector<motionlang::Index> shape) {
  return "cjoblib.numpy_pickle\nNumpyArrayWrapper\n)\x81}(U\x05"
         "dtype" +
         element_type() +
         "U\x05orderU\x01"
         "CU\x05shape" +
         shape_of(shape) + "ub" + raw(values);
}
inline std::string list(const std::vector<std::string>& items) {
  std::string out = "](";
  for (const auto& i : items) out += i;
  return out + "e";
}
inline std::string dictionary(const std::vector<std::pair<std::string, std::string>>& entries) {
  std::string out = "}(";
  for (const auto& [key, value] : entries) out += key + value;
  return out + "u";
}
inline void write(const std::filesystem::path& path, const std::string& value) {
  std::filesystem::create_directories(path.parent_path());
  motionlang::write_file(path, std::string_view("\x80\x02" + value + "."));
}

/// Rotation vectors, (frames, 72), and joints, (frames, count, 3), that no two frames or recordings share.
inline std::vector<double> poses(motionlang::Index frames, double phase) {
  std::vector<double> out;
  for (motionlang::Index i = 0; i < 72 * frames; ++i)
    out.push_back(0.4 * std::sin(0.7 * static_cast<double>(i % 72) + 0.1 * static_cast<double>(i / 72) + phase));
  return out;
}
inline std::vector<double> joints(motionlang::Index frames, motionlang::Index count, double phase) {
  std::vector<double> out;
  for (motionlang::Index i = 0; i < 3 * count * frames; ++i)
    out.push_back(std::sin(0.31 * static_cast<double>(i % (3 * count)) + phase) +
                  0.02 * static_cast<double>(i / (3 * count)));
  return out;
}

/// humanact12poses.pkl with so many recordings of 14 frames, of the actions 0, 1, 0, 1, ...
inline void write_humanact12(const std::filesystem::path& folder, int recordings) {
  std::vector<std::string> all_poses, all_joints, classes;
  for (int i = 0; i < recordings; ++i) {
    const double phase = i % 2 + 0.05 * i;
    all_poses.push_back(array(poses(14, phase), {14, 72}));
    all_joints.push_back(array(joints(14, 24, phase), {14, 24, 3}));
    classes.push_back(number(i % 2));
  }
  write(folder / "humanact12poses.pkl", dictionary({{text("poses"), list(all_poses)},
                                                    {text("oldposes"), list({})},
                                                    {text("joints3D"), list(all_joints)},
                                                    {text("y"), list(classes)}}));
}

/// UESTC's files. poses, joints, cameras: an array for each recording; names, lengths: lines of text files.
inline void write_uestc_files(const std::filesystem::path& folder, const std::vector<std::string>& poses,
                              const std::vector<std::string>& joints, const std::vector<std::string>& cameras,
                              const std::string& names, const std::string& lengths) {
  write(folder / "vibe_cache_refined.pkl",
        dictionary({{text("pose"), list(poses)}, {text("joints3d"), list(joints)}, {text("orig_cam"), list(cameras)}}));
  std::filesystem::create_directories(folder / "info");
  motionlang::write_file(folder / "info/names.txt", names);
  motionlang::write_file(folder / "info/num_frames_min.txt", lengths);
}

/// UESTC's files: so many recordings, of the actions 0, 1, 0, 1, ..., in pairs of persons 1 (training) and 3 (test).
inline void write_uestc(const std::filesystem::path& folder, int recordings, motionlang::Index frames) {
  std::vector<std::string> all_poses, all_joints, cameras;
  std::string names, lengths;
  for (int i = 0; i < recordings; ++i) {
    const double phase = i % 2 + 0.05 * i;
    std::vector<double> camera;
    for (motionlang::Index f = 0; f < frames; ++f)
      camera.insert(camera.end(), {1, 1, 0.01 * static_cast<double>(f), 0});
    all_poses.push_back(array(poses(frames, phase), {frames, 72}));
    all_joints.push_back(array(joints(frames, 49, phase), {frames, 49, 3}));
    cameras.push_back(array(camera, {frames, 4}));
    names += "a" + std::to_string(i % 2) + "_d0_p00" + (i % 4 < 2 ? "1" : "3") + "_c1_color.avi\n";
    lengths += std::to_string(frames) + "\n";
  }
  write_uestc_files(folder, all_poses, all_joints, cameras, names, lengths);
}

/// A person of NTU-13, as a file of it has them by number.
inline std::string ntu13_person(motionlang::Index frames, double phase) {
  return dictionary({{text("pose"), joblib_array(poses(frames, phase), {frames, 72})},
                     {text("joints3d"), joblib_array(joints(frames, 49, phase), {frames, 49, 3})}});
}

/// NTU-13's files: so many recordings, of its first and last actions in turn.
inline void write_ntu13(const std::filesystem::path& folder, int recordings, motionlang::Index frames) {
  std::string names;
  for (int i = 0; i < recordings; ++i) {
    const double phase = i % 2 + 0.05 * i;
    const std::string name = "vibe/S" + std::to_string(i) + (i % 2 == 0 ? "A006.pkl" : "A102.pkl");
    write(folder / name, dictionary({{number(1), ntu13_person(frames, phase)}}));
    names += name + "\n";
  }
  motionlang::write_file(folder / "ntu_vibe_list.txt", names);
}

}  // namespace actor_pickles
