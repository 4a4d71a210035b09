// SPDX-License-Identifier: MIT
// Bodies of the headers in formats/, compiled once for motionlang::instantiated.
#include <motionlang/formats/amass.ipp>
#include <motionlang/formats/amass_body.ipp>
#include <motionlang/formats/amass_sequence.ipp>
#include <motionlang/formats/amc.ipp>
#include <motionlang/formats/body_file.ipp>
#include <motionlang/formats/bvh.ipp>
#include <motionlang/formats/bvh_text.ipp>
#include <motionlang/formats/detail/figure_mesh.ipp>
#include <motionlang/formats/detail/figure_pose.ipp>
#include <motionlang/formats/features_npy.ipp>
#include <motionlang/formats/figure.ipp>
#include <motionlang/formats/mdm_results.ipp>
#include <motionlang/formats/merged_body.ipp>
#include <motionlang/formats/motion_npy.ipp>
#include <motionlang/formats/skeleton_table_file.ipp>
