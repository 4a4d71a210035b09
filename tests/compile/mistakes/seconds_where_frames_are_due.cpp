// SPDX-License-Identifier: MIT
// A timeline in seconds where motion is made in frames.
// expect: BasicTimeline<double>
#include <motionlang/compose/timeline.hpp>

namespace ml = motionlang;

ml::Index last_frame(const ml::Timeline& timeline) { return timeline.end(); }

#ifdef MISTAKE
ml::Index last_frame_of(const ml::TimelineInSeconds& timeline) { return last_frame(timeline); }
#else
ml::Index last_frame_of(const ml::TimelineInSeconds& timeline) { return last_frame(ml::to_frames(timeline, 20)); }
#endif
