// SPDX-License-Identifier: MIT
// Bodies of the headers in features/, compiled once for motionlang::instantiated.
#include <motionlang/features/actor_points.ipp>
#include <motionlang/features/describe_features.ipp>
#include <motionlang/features/feature_rows.ipp>
#include <motionlang/features/frame_sampling.ipp>
#include <motionlang/features/layout.ipp>
#include <motionlang/features/motion_features.ipp>
#include <motionlang/features/pose_representation.ipp>
#include <motionlang/features/smplrifke.ipp>
#include <motionlang/features/statistics.ipp>
