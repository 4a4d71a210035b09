// SPDX-License-Identifier: MIT
/// A folder in which the program is run on models as published.
#pragma once

#include <doctest/doctest.h>

#include <motionlang/formats/body_file.hpp>
#include <motionlang/metrics/stgcn.hpp>

#include "../support/temporary_folder.hpp"
#include "process.hpp"

namespace ml = motionlang;

struct OfficialWorkplace : TemporaryFolder {
  Outcome run(const std::vector<std::string>& arguments) const { return ::run(arguments, path); }
  /// Runs a command that has to go well, and gives what it said.
  std::string did(const std::vector<std::string>& arguments) const {
    const Outcome o = run(arguments);
    CHECK_MESSAGE(o.code == 0, o.text);
    return o.text;
  }
  /// Frames and joints of the positions that a generation wrote.
  std::vector<ml::Index> joints(const std::string& file) const { return ml::read_npy(path / file).shape; }
};
