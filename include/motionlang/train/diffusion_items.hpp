// SPDX-License-Identifier: MIT
/// The frames and the text with which a motion is learned in one step, as the programs of MDM-SMPL, MDM and
/// MotionDiffuse draw them.
///
/// Source  STMC src/data/text_motion.py; MDM data_loaders/humanml/data/dataset.py; MotionDiffuse
///         text2motion/datasets/dataset.py
#pragma once

#include <string>  // texts

#include <motionlang/core/rng.hpp>
#include <motionlang/datasets/described_motions.hpp>
#include <motionlang/weights/diffusion_training_config.hpp>

MOTIONLANG_NAMESPACE_BEGIN

struct DiffusionItem {
  std::string text;
  FrameSlice frames;
  bool operator==(const DiffusionItem&) const = default;
};

/// A random text. The share `drop` has the text "" instead, and of these the share items.transitions any short part of
/// the motion. Otherwise up to items.cut of the frames of the text are cut off, divided at random between both ends.
/// Differs  from the program of STMC, whose slice [a : -b] is empty for b = 0
DiffusionItem mdm_smpl_item(const DescribedMotion& motion, Index frames, const MdmSmplItemConfig& items, double drop,
                            Philox rng);

/// A random text, and a random part of its frames: whole units, and in a third of the cases one unit less. At most
/// `longest`.
DiffusionItem mdm_item(const DescribedMotion& motion, Philox rng, Index unit = 4, Index longest = 196);

/// A random text and all its frames, or a random part of them if there are more than `longest`.
DiffusionItem motiondiffuse_item(const DescribedMotion& motion, Philox rng, Index longest = 196);

/// The first text and all its frames, at most `longest`: for validation. longest 0: any number.
DiffusionItem first_item(const DescribedMotion& motion, Index longest = 0);

MOTIONLANG_NAMESPACE_END

#ifndef MOTIONLANG_INSTANTIATED
#include <motionlang/train/diffusion_items.ipp>
#endif
