// SPDX-License-Identifier: MIT
/// Known errors in the files of AMASS, and folders that change their names between releases.
///
///     sequence.fps = corrected_amass_fps(path, sequence.fps);
///     // The file of an annotation, of any release.
///     for (const std::string& file : amass_paths(babel.feat_p)) use(file);
///
/// No reader corrects a rate by itself, because a resampled file may have the same name and a correct rate.
/// Source  TEACH (Athanasiou et al., 3DV 2022), amass_files
#pragma once

#include <array>        // tables
#include <string>       // paths
#include <string_view>  // names
#include <vector>       // paths

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// The true frames per second of a released sequence, whatever its file says.
struct AmassRate {
  std::string_view path;  // a part of it
  double fps = 0;
};
inline constexpr std::array<AmassRate, 3> amass_rates{
    {{"BMLhandball", 240}, {"20160930_50032", 59}, {"20161014_50033", 59}}};

/// fps: the rate in the file. Returns it if it is right, otherwise the true rate.
double corrected_amass_fps(std::string_view path, double fps);

/// Folders of data sets: the names in annotations such as those of HumanML3D and BABEL, and the names of today's
/// release.
struct AmassRename {
  std::string_view before, today;
};
inline constexpr std::array<AmassRename, 8> amass_renames{{{"BioMotionLab_NTroje", "BMLrub"},
                                                           {"DFaust_67", "DFaust"},
                                                           {"MPI_HDM05", "HDM05"},
                                                           {"MPI_Limits", "PosePrior"},
                                                           {"MPI_mosh", "MoSh"},
                                                           {"SSM_synced", "SSM"},
                                                           {"TCD_handMocap", "TCDHands"},
                                                           {"Transitions_mocap", "Transitions"}}};

/// The path of a sequence, followed by its older and newer names if they differ from it.
std::vector<std::string> amass_paths(std::string_view path);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/datasets/amass_releases.ipp>
#endif
