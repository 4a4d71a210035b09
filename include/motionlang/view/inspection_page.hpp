// SPDX-License-Identifier: MIT
/// The findings of a folder of motions as one self-contained HTML page: a table that counts the faults, then every
/// motion with its findings and, for some of each kind, a film strip.
#pragma once

#include <array>        // counts
#include <span>         // motions
#include <string>       // texts
#include <string_view>  // title
#include <vector>       // findings

#include <motionlang/metrics/inspect_motion.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// A motion of the page, or a file that could not be read.
struct InspectedMotion {
  std::string name;                 // path, and animation if there are several
  std::string about;                // length, frame rate, joints
  std::string unreadable{};         // the error of the reader; "": it was read
  std::vector<Finding> findings{};  // empty: no fault
  std::string strip{};              // film_strip_svg, or "" for none

  bool good() const { return unreadable.empty() && findings.empty(); }
};

/// The number of motions with each fault, by Fault.
std::array<Index, fault_info.size()> count_faults(std::span<const InspectedMotion> motions);

/// title   of the page, the name of the folder
std::string inspection_html(std::span<const InspectedMotion> motions, std::string_view title);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/view/inspection_page.ipp>
#endif
