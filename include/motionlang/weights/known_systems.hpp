// SPDX-License-Identifier: MIT
/// The systems whose models this library loads: their names, and where a published folder has its weights. A new system
/// is a row of this table, and a rule in run_folder.ipp that tells its folder from others.
///
///     const KnownSystem* system = known_system("temos");   // system->title == "TEMOS"; null for an unknown name
#pragma once

#include <array>        // places
#include <span>         // the table
#include <string_view>  // names

#include <motionlang/version.hpp>

MOTIONLANG_NAMESPACE_BEGIN

/// Where weights may be: the first of `names` in a folder, else the file with the largest number whose name begins and
/// ends with these texts.
struct WeightsPlace {
  std::string_view folder{};                // below that of the run; "": that one
  std::array<std::string_view, 2> names{};  // "": none
  std::string_view begins{}, ends{};
};

struct KnownSystem {
  std::string_view name;                  // as model folders and RunFolder::system say it
  std::string_view title;                 // as people write it
  std::string_view folder_of{};           // the system whose folders look the same; "": none
  bool diffusion = false;                 // a diffusion model of texts, whose motions STMC composes
  bool trained_generates = false;         // load_trained_motion_model.hpp loads what our training of it wrote
  bool modules = false;                   // the published folder has a file of weights for each module
  std::array<WeightsPlace, 2> weights{};  // in the order of preference; empty: none
};

/// All of them.
std::span<const KnownSystem> known_systems();

/// The row with this name; null if there is none.
const KnownSystem* known_system(std::string_view name);
/// True for the name of a diffusion model of texts.
bool is_diffusion_system(std::string_view name);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/weights/known_systems.ipp>
#endif
