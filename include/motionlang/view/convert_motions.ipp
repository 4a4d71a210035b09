// SPDX-License-Identifier: MIT
// Bodies of convert_motions.hpp.
#pragma once

#include <algorithm>  // any_of, max
#include <cstdio>     // lines
#include <exception>  // failures
#include <sstream>    // lines
#include <utility>    // move

#include <motionlang/core/option_error.hpp>
#include <motionlang/core/text_lines.hpp>
#include <motionlang/core/utf8.hpp>
#include <motionlang/datasets/humanml3d_clip.hpp>
#include <motionlang/features/feature_rows.hpp>
#include <motionlang/features/motion_features.hpp>
#include <motionlang/formats/amass.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/formats/features_npy.hpp>
#include <motionlang/formats/vrma.hpp>
#include <motionlang/geometry/box.hpp>
#include <motionlang/kinematics/motion_tools.hpp>
#include <motionlang/kinematics/retarget.hpp>
#include <motionlang/kinematics/up_axis.hpp>
#include <motionlang/view/convert_motions.hpp>
#include <motionlang/view/view_file.hpp>

MOTIONLANG_NAMESPACE_BEGIN

namespace detail {

/// The file for one of several motions: out_walk.bvh, and out_walk_2.bvh for another "walk".
inline std::filesystem::path several_name(std::filesystem::path out, const std::string& name,
                                          std::set<std::string>& taken) {
  const std::string extension = out.extension().string();
  return unique_name(out.replace_extension().string() + "_" + safe_file_name(name), taken) + extension;
}

/// The longest side of the box around a rest pose, which stands, sits or lies.
inline double reach_of(const Skeleton& skeleton) {
  if (skeleton.size() == 0) return 0;
  const auto positions = skeleton.rest_positions();
  const Box box = box_of(positions);
  const auto size = box.high - box.low;
  return std::max({size.x, size.y, size.z});
}

/// Rates and times for readers: "20 per second, 3.00 s".
inline std::string rate_and_time(double fps, double seconds) {
  char text[96];
  std::snprintf(text, sizeof text, "%g per second, %.2f s", fps, seconds);
  return text;
}

/// A line about names of joints that a BVH file cannot hold, if there are some.
inline std::string changed_names(const std::filesystem::path& path, const Skeleton& skeleton) {
  const std::vector<std::string> names = bvh_names(skeleton);
  std::size_t changed = 0, first = 0;
  for (std::size_t j = names.size(); j-- > 0;) {
    if (names[j] != skeleton.names[j]) first = j, ++changed;
  }
  if (changed == 0) return {};
  const std::string line =
      concat_text(path.string(), ": ",
                  changed == 1 ? "the name of 1 joint is" : concat_text("the names of ", changed, " joints are"),
                  " not as a BVH file can hold: '", skeleton.names[first], "' is '", names[first], "' in it\n");
  return printable(line, "\n");
}

/// A line about joints that VRM has no bones for, if there are some.
inline std::string missing_bones(const std::filesystem::path& path, const Skeleton& skeleton) {
  const Skeleton bones = vrm_skeleton(skeleton);
  if (bones.names == skeleton.names) return {};
  const std::vector<std::string> left_out = SkeletonMap(skeleton, bones).report().unused;
  if (left_out.empty()) return {};
  const std::string line = concat_text(
      path.string(), ": ", counted(bones.size(), "bone"), "; VRM has none for '", left_out.front(), "'",
      left_out.size() > 1 ? concat_text(" and ", counted(left_out.size() - 1, "other joint")) : std::string(), "\n");
  return printable(line, "\n");
}

class OneConversion {
 public:
  OneConversion(std::filesystem::path in, std::filesystem::path out, const MotionConversion& how,
                ConversionNotes& notes, std::set<std::string>& taken)
      : in_(std::move(in)), out_(std::move(out)), how_(how), notes_(notes), taken_(taken) {}

  void run() {
    if (file_kind(in_) != ".npz")
      motions_ = read_motions(in_, how_.read, &notes_.input);
    else if (how_.body == nullptr)
      read_amass_file();
    else
      read_for_body();
    RetargetReport report;
    for (const Motion& m : motions_) note(m);
    for (const Motion& m : motions_) attempt(m.name, [&] { made_.push_back(edited(m, report)); });
    if (!report.table.empty()) notes_.results += to_string(report) + "\n";
    if (!made_.empty()) write();
    if (failures_ > 0)
      raise<config_error>(101, "convert: ", failures_, " of the ", counted(motions_.size(), "motion"), " of ",
                          in_.string(), " could not be made:", reasons_);
  }

 private:
  /// Notes about a motion for the user who converts it.
  void note(const Motion& m) {
    const std::string where = in_.string() + (motions_.size() == 1 ? "" : " " + m.name) + ": ";
    char text[160];
    if (const Index frames = detect_t_pose_lead_in(m); frames > 0 && how_.time.from == 0) {
      std::snprintf(text, sizeof text,
                    "begins with %s of a T-pose in front of the recording; `from` %.3g leaves it out",
                    counted(frames, "frame").c_str(), static_cast<double>(frames) / m.fps);
      notes_.input += where + text + "\n";
    }
    if (const auto stands = find_up_axis(m); stands && file_kind(in_) != ".npz") {
      const std::string axis(to_string(stands->axis));  // "-Y"
      std::snprintf(text, sizeof text, "the figure stands along %s, not +Y: `up` %c%s turns it up", axis.c_str(),
                    lower(axis[1]), axis[0] == '-' ? "-down" : "");
      notes_.input += where + text + "\n";
    }
    constexpr double smallest = 0.5, largest = 4;  // metres
    const double reach = reach_of(m.skeleton);
    if (reach > 0 && (reach < smallest || reach > largest)) {
      std::snprintf(text, sizeof text, "the figure is %.2g m large%s", reach,
                    file_kind(in_) == ".bvh" ? ": set `scale` to the length of its unit in metres" : "");
      notes_.input += where + text + "\n";
    }
  }
  /// Shape and gender are kept for AMASS files; joints and features do not have them, nor hands.
  void read_amass_file() {
    AmassSequence sequence = read_amass_sequence(in_, how_.read.rate);
    motions_.push_back(amass_motion(sequence, in_.stem().string()));
    const auto is_set = [](double x) { return x != 0; };
    bool hands = false;
    for (Index f = 0; f < sequence.frames; ++f) {
      const auto columns = static_cast<std::size_t>(sequence.columns);
      const auto row = std::span(sequence.poses).subspan(static_cast<std::size_t>(f) * columns, columns).subspan(66);
      hands = hands || std::any_of(row.begin(), row.end(), is_set);
    }
    const bool shape = std::any_of(sequence.betas.begin(), sequence.betas.end(), is_set) && file_kind(out_) != ".npz";
    if (hands || shape)
      notes_.input = in_.string() + ": left out: " +
                     (hands && shape ? "hands, face and betas"
                      : hands        ? "hands and face"
                                     : "betas") +
                     "; `body` shows them\n";
    amass_ = {std::move(sequence.gender), std::move(sequence.betas)};
  }
  void read_for_body() {
    BodyClip clip = how_.body->read(in_, how_.read.rate);
    motions_.push_back(std::move(clip.motion));
    betas_ = std::move(clip.betas);
    notes_.input = std::move(clip.notes);
    if (how_.denoise && clip.has_more)
      notes_.input += in_.string() + ": what `denoise` makes is without hands and face\n";
  }

  /// True if the motion must be on SMPL's joints: for features that are not on the clip's own joints, arrays of
  /// positions and AMASS files. Feet are fixed there. The user's body has these joints or its own.
  bool wants_smpl(const Motion& m) const {
    if (how_.body != nullptr && !how_.body->has_joints_of(m)) return true;
    if (how_.body != nullptr && !how_.body->takes_any_joints()) return false;
    const std::string features = how_.data_set != nullptr ? std::string(how_.data_set->features) : how_.features;
    const bool others = !features.empty() && !has_joints_of(motion_features(features), m);
    const std::string kind = file_kind(out_);
    const bool unknown_order = features.empty() && kind == ".npy" && !has_joints_of_arrays(m);
    return how_.edits.smpl || how_.edits.fix_feet || others || unknown_order || kind == ".npz";
  }
  /// `report` is set if the joints were other than SMPL's and had to become SMPL's.
  Motion edited(Motion m, RetargetReport& report) const {
    m = edit_time(std::move(m), how_.time);
    if (how_.denoise) m = how_.denoise(m);
    MotionEdits edits = how_.edits;
    edits.smpl = wants_smpl(m);
    m = edit_motion(std::move(m), edits, &report);
    if (how_.skeleton && m.skeleton != *how_.skeleton) m = retarget(m, *how_.skeleton);
    return m;
  }

  /// If one of several motions fails, it is reported, and the others continue.
  template <class Work>
  void attempt(const std::string& name, Work work) {
    guard<error>(work, [&](const error& e) {
      if (motions_.size() == 1) return false;
      reasons_ += "\n" + name + ": " + e.what();
      ++failures_;
      return true;
    });
  }

  void write() {
    how_.inputs.refuse(out_);
    if (how_.rig) {
      notes_.results += how_.rig(out_, made_);
    } else if (how_.body != nullptr && holds_several(out_)) {
      write_on_body(out_, made_);
    } else if (motions_.size() > 1 && how_.features.empty() && holds_together(out_, made_)) {
      write_motions(out_, made_);
      notes_.results += concat_text(out_.string(), ": ", counted(made_.size(), "motion"), ", ",
                                    counted(made_.front().skeleton.size(), "joint"), "\n");
    } else if (how_.data_set != nullptr) {
      for (const Motion& m : made_)
        attempt(m.name, [&] { write_clip(unique_name(safe_file_name(m.name), taken_), m); });
    } else {
      for (const Motion& m : made_) {
        const auto path = motions_.size() == 1 ? out_ : several_name(out_, m.name, taken_);
        attempt(m.name, [&] { write_one(path, m); });
      }
    }
  }
  void write_on_body(const std::filesystem::path& path, const std::vector<Motion>& motions) {
    const BodyFiles made = how_.body->write(path, motions, betas_);
    const std::string files =
        file_kind(path) == ".obj" ? concat_text(" in ", counted(made.files, "file"), ", one for each frame") : "";
    notes_.results += concat_text(path.string(), files, ": ", counted(motions.size(), "motion"), " on ", made.body,
                                  " of ", made.vertices, " vertices\n");
  }
  void write_clip(const std::string& id, const Motion& m) {
    const AddedClip clip = add_humanml3d_clip(out_, id, m, *how_.data_set, how_.time.fps, how_.replace);
    char rate[32];
    std::snprintf(rate, sizeof rate, "%g", clip.fps);
    notes_.results += concat_text(out_.string(), ": clip ", id, ", ", counted(clip.frames, "frame"), " at ", rate,
                                  " per second, ", counted(clip.captions, "caption"), "\n");
  }
  void write_one(const std::filesystem::path& path, const Motion& m) {
    how_.inputs.refuse(path);
    if (how_.body != nullptr) return write_on_body(path, {m});
    if (!how_.features.empty()) return write_features(path, m);
    write_motion_or_view(path, m, {.scale = how_.scale, .body = amass_.value_or(AmassBody{})});
    notes_.results += line_about_motion(path, m);
  }
  void write_features(const std::filesystem::path& path, const Motion& m) {
    if (file_kind(path) != ".npy")
      raise<option_error>(103, path.string(), ": features are written to .npy, not '", file_kind(path), "'");
    const FeatureRows made = write_features_npy(path, m, motion_features(how_.features), how_.time.fps);
    notes_.results += concat_text(path.string(), ": ", counted(made.rows, "row"), " of ", made.width, " numbers at ",
                                  rate_and_time(made.fps, made.seconds()), "\n");
  }

  std::filesystem::path in_, out_;
  const MotionConversion& how_;
  ConversionNotes& notes_;
  std::set<std::string>& taken_;
  std::vector<Motion> motions_;
  std::vector<float> betas_;        // of an AMASS file, for a body
  std::optional<AmassBody> amass_;  // the same for another AMASS file
  std::vector<Motion> made_;
  std::string reasons_;
  std::size_t failures_ = 0;
};

}  // namespace detail

MOTIONLANG_BODY std::string line_about_motion(const std::filesystem::path& path, const Motion& motion) {
  const std::string kind = file_kind(path), changed = kind == ".bvh"    ? detail::changed_names(path, motion.skeleton)
                                                      : kind == ".vrma" ? detail::missing_bones(path, motion.skeleton)
                                                                        : "";
  return concat_text(path.string(), ": ", counted(motion.frames(), "frame"), " at ",
                     detail::rate_and_time(motion.fps, motion.seconds()), ", ",
                     counted(motion.skeleton.size(), "joint"), "\n", changed);
}

MOTIONLANG_BODY void convert_motions(const std::filesystem::path& in, const std::filesystem::path& out,
                                     const MotionConversion& how, ConversionNotes* notes,
                                     std::set<std::string>* taken) {
  ConversionNotes own_notes;
  std::set<std::string> own_names;
  detail::OneConversion(in, out, how, notes != nullptr ? *notes : own_notes, taken != nullptr ? *taken : own_names)
      .run();
}

// Written motions must not be among the originals: they could replace a file that is still to be read. In a folder
// below the originals, the next run would not read them.
MOTIONLANG_BODY std::vector<std::filesystem::path> files_to_convert(const std::filesystem::path& in,
                                                                    const std::filesystem::path& out,
                                                                    const std::string& extension,
                                                                    std::string* skipped) {
  const bool are_motions = is_motion_file("a" + extension);
  if (are_motions && is_same_place(in, out))
    raise<option_error>(102, "convert: ", extension, " files of ", in.string(),
                        " cannot go into the folder itself: choose another one, for example below it");
  auto files = motion_files_below(in, are_motions ? out : std::filesystem::path(), skipped);
  if (files.empty()) raise<config_error>(101, "convert: no motion file in ", in.string());
  return files;
}

MOTIONLANG_BODY void convert_files(const std::vector<std::filesystem::path>& files, const std::filesystem::path& in,
                                   const std::filesystem::path& out, const std::string& extension, MotionConversion how,
                                   FolderConversion& result, Progress progress) {
  result.files = files.size();
  for (const auto& file : files) how.inputs.add(file);
  const MotionReadOptions read = how.read;
  std::set<std::string> taken;
  for (const auto& file : files) {
    ConversionNotes notes;
    const auto convert = [&] {
      how.read = options_for_file(read, file);
      std::filesystem::path to = out;
      if (out.empty()) {
        to = beside_motion(file, extension);
      } else if (how.data_set == nullptr) {
        const auto place = out / file.lexically_relative(in).replace_extension();
        std::filesystem::create_directories(place.parent_path());
        to = unique_name(place.string(), taken) + extension;
      }
      convert_motions(file, to, how, &notes, &taken);
    };
    const auto failed = [&](const std::exception& e) {
      result.failures.push_back(file.string() + ": " + e.what());
      return true;
    };
    if (detail::guard<std::exception>(convert, failed)) {
      ++result.converted;
      std::istringstream lines(notes.input);
      for (std::string line; std::getline(lines, line);) {
        const std::string name = file.string();
        auto& [first, more] = result.notes[line.starts_with(name) ? line.substr(name.size()) : line];
        if (first.empty())
          first = line;
        else
          ++more;
      }
    }
    ++result.done;
    progress(static_cast<Index>(result.done), static_cast<Index>(files.size()));
  }
}

MOTIONLANG_BODY void convert_folder(const std::filesystem::path& in, const std::filesystem::path& out,
                                    const std::string& extension, MotionConversion how, FolderConversion& result,
                                    Progress progress) {
  const auto files = files_to_convert(in, out, how.data_set != nullptr ? ".npy" : extension);
  convert_files(files, in, out, extension, std::move(how), result, progress);
}

MOTIONLANG_NAMESPACE_END
