// SPDX-License-Identifier: MIT
/// Files as torch.save writes them.
#pragma once

#include <motionlang/file/torch_archive.hpp>

using motionlang::TorchArchive;
