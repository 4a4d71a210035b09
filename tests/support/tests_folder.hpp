// SPDX-License-Identifier: MIT
/// The folder tests/ of the sources, for files that are part of the repository. Defined in doctest_main.cpp.
/// __FILE__ does not lead to it: where ccache has a `base_dir`, that is a path from the build folder.
#pragma once

const char* tests_folder();
