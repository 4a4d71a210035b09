// SPDX-License-Identifier: MIT
// Bodies of the headers in datasets/, compiled once for motionlang::instantiated.
#include <motionlang/datasets/action_recordings.ipp>
#include <motionlang/datasets/amass_releases.ipp>
#include <motionlang/datasets/babel_segment.ipp>
#include <motionlang/datasets/data_set_form.ipp>
#include <motionlang/datasets/guo_clip.ipp>
#include <motionlang/datasets/humanml3d_clip.ipp>
#include <motionlang/datasets/humanml3d_folder.ipp>
#include <motionlang/datasets/humanml3d_source.ipp>
#include <motionlang/datasets/humanml3d_texts.ipp>
#include <motionlang/datasets/make_humanml3d.ipp>
#include <motionlang/datasets/motion_tokens.ipp>
#include <motionlang/datasets/simultaneous_segments.ipp>
#include <motionlang/datasets/sinc_items.ipp>
#include <motionlang/datasets/teach_pairs.ipp>
#include <motionlang/datasets/tm2t_data.ipp>
#include <motionlang/datasets/training_set.ipp>
