// Files of motion as the commands read and write them: their options, checks of paths before long work, and the lines
// that commands print. motionlang/formats/motion_file.hpp and motionlang/view/view_file.hpp do the reading and writing.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <motionlang/datasets/data_set_form.hpp>
#include <motionlang/features/feature_rows.hpp>
#include <motionlang/file/input_files.hpp>
#include <motionlang/file/output_folder.hpp>
#include <motionlang/formats/motion_folder.hpp>
#include <motionlang/view/rig_writer.hpp>
#include <motionlang/view/shown_body.hpp>
#include <motionlang/view/view_file.hpp>

#include "../usage_error.hpp"

namespace CLI {
class App;
}

namespace program {

namespace ml = motionlang;

/// The help of --joints.
inline constexpr const char* joints_help =
    "Table for skeletons with unknown names or axes, with lines 'joint of SMPL<TAB>joint[<TAB>axes]', such as "
    "'left_hip' "
    "and 'LeftThigh'. The axes of the joint are those that point left and up in a T-pose; the default is +x+y. With "
    "--rig the table describes the character. Otherwise it retargets motions to SMPL's joints";

struct MotionReadOptions : ml::MotionReadOptions {
  /// --scale, --rate, --up, --asf, --joints
  void add_to(CLI::App& command);
  /// Throws usage_error 102 for an option that does not apply to files of this kind.
  void require_for(const std::filesystem::path& file) const;
};

using ml::DataSetForm;
using ml::find_data_set_form;
using ml::is_same_place;
using ml::make_output_folder;
using ml::on_smpl;
using ml::read_motions;
using ml::require_folder_of;
using ml::safe_file_name;
using ml::unique_name;

/// Extension of a file, in lower case: ".bvh".
inline std::string kind_of(const std::filesystem::path& path) { return ml::file_kind(path); }

/// Calls ml::motion_files_below, and prints skipped files on stderr.
std::vector<std::filesystem::path> motion_files_below(const std::filesystem::path& folder,
                                                      const std::filesystem::path& results = {});

/// The motions of a file without T-poses that an exporter put at their start (detect_t_pose_lead_in), for commands that
/// combine motions. Prints what is left out.
std::vector<ml::Motion> read_performed_motions(const std::filesystem::path& path, ml::MotionReadOptions options = {});
/// The only motion of a file. Throws config_error 102 if there are several, and as read_motions.
ml::Motion read_only_performed_motion(const std::filesystem::path& path, ml::MotionReadOptions options = {});

/// Calls ml::write_motion_or_view. Returns a line about the file.
std::string write_motion(const std::filesystem::path& path, const ml::Motion& motion, double bvh_units_per_metre = 100);

/// The body of --body; null if the options name none. Throws what ml::load_shown_body throws.
std::unique_ptr<const ml::ShownBody> shown_body(const ml::ShownBodyOptions& options);

}  // namespace program
