// SPDX-License-Identifier: MIT
// Bodies of the headers in view/ that need nlohmann/json.hpp, compiled once for motionlang::instantiated.
#include <motionlang/view/convert_motions.ipp>
#include <motionlang/view/describe_motion.ipp>
#include <motionlang/view/gallery_page.ipp>
#include <motionlang/view/inspect_folder.ipp>
#include <motionlang/view/rig_viewer.ipp>
#include <motionlang/view/rig_writer.ipp>
#include <motionlang/view/search_page.ipp>
#include <motionlang/view/studio_page.ipp>
#include <motionlang/view/study_page.ipp>
#include <motionlang/view/view_file.ipp>
#include <motionlang/view/viewer.ipp>
#include <motionlang/view/word_charts.ipp>
