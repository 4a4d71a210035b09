// SPDX-License-Identifier: MIT
/// Made-up sources of HumanML3D: a checkout of its repository, AMASS, and SMPL-H.
#pragma once

#include <cmath>

#include <motionlang/datasets/make_humanml3d.hpp>
#include <motionlang/file/npz.hpp>

#include "octahedra_body.hpp"
#include "synthetic_motion.hpp"
#include "temporary_folder.hpp"

namespace made_up {

namespace ml = motionlang;

inline ml::NpyArray array(const std::vector<double>& values, std::vector<ml::Index> shape) {
  return ml::NpyArray::of(std::span<const double>(values), std::move(shape));
}

/// A body with ten directions of shape, of which the first one makes it taller.
inline std::vector<ml::NamedArray> smplh() {
  auto out = octahedra::arrays(ml::BodyKind::smplh);
  for (ml::NamedArray& a : out) {
    if (a.name != "shapedirs") continue;
    std::vector<double> directions;
    for (const double x : a.array.to<double>()) {
      directions.push_back(x);
      directions.insert(directions.end(), 9, 0);
    }
    a.array = array(directions, {a.array.shape[0], 3, 10});
  }
  return out;
}

/// A checkout of the repository, AMASS and bodies, all made up. The index has a clip of AMASS under a name of today's
/// release, one of HumanAct12, and one whose source is missing.
struct HumanMl3d : TemporaryFolder {
  ml::HumanMl3dSources sources{*this / "repository", *this / "AMASS", *this / "bodies"};
  std::filesystem::path out = *this / "out";

  HumanMl3d() {
    namespace fs = std::filesystem;
    for (const char* name : {"male", "female"}) {
      fs::create_directories(sources.bodies / "smplh" / name);
      ml::write_npz(sources.bodies / "smplh" / name / "model.npz", smplh());
    }
    fs::create_directories(sources.repository / "HumanML3D/texts");
    fs::create_directories(sources.repository / "pose_data/humanact12");
    fs::create_directories(sources.amass / "HDM05/a");
    ml::write_file(sources.repository / "index.csv",
                   std::string_view("source_path,start_frame,end_frame,new_name\n"
                                    "./pose_data/MPI_HDM05/a/walk_poses.npy,2,60,000000.npy\n"
                                    "./pose_data/humanact12/P01.npy,0,0,000001.npy\n"
                                    "./pose_data/KIT/3/kick_poses.npy,0,40,000002.npy\n"));
    ml::write_file(sources.repository / "HumanML3D/texts/000000.txt",
                   std::string_view("a person turns left.#a/DET person/NOUN turn/VERB left/ADV#0.0#0.0\n"));
    ml::write_file(sources.repository / "HumanML3D/train.txt", std::string_view("000000\nM000000\n000002\n"));

    const ml::Motion walk = synthetic::walk({.frames = 250, .fps = 40});
    std::vector<double> poses, trans;
    for (ml::Index t = 0; t < walk.frames(); ++t) {
      std::vector<double> pose(156);
      for (std::size_t k = 0; k < pose.size(); ++k)
        pose[k] = 0.2 * std::sin(0.1 * static_cast<double>(t) + static_cast<double>(k));
      pose[0] = 1.5, pose[1] = pose[2] = 0.1;  // from Y up to Z up
      poses.insert(poses.end(), pose.begin(), pose.end());
      trans.insert(trans.end(), {0.01 * static_cast<double>(t), 0, 0.9});
    }
    ml::write_npz(sources.amass / "HDM05/a/walk_poses.npz",
                  std::vector<ml::NamedArray>{{"poses", array(poses, {walk.frames(), 156})},
                                              {"trans", array(trans, {walk.frames(), 3})},
                                              {"betas", array({0.5, 0, 0, 0, 0, 0, 0, 0, 0, 0}, {10})},
                                              {"gender", ml::NpyArray::text("male")},
                                              {"mocap_framerate", ml::NpyArray::scalar(40.0)}});
    std::vector<double> joints;
    for (const auto& p : walk.positions()) joints.insert(joints.end(), {p.x, p.y, p.z});
    ml::write_npy(sources.repository / "pose_data/humanact12/P01.npy", array(joints, {walk.frames(), 24, 3}));
  }
};

}  // namespace made_up
