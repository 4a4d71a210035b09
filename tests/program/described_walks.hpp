// SPDX-License-Identifier: MIT
/// Walks with texts of which every word has its part of speech, as the networks of Guo et al. read them.
#pragma once

#include <string>
#include <vector>

#include <motionlang/file/id_list.hpp>

#include "training_clips.hpp"

/// A word of the text of each of these walks.
inline constexpr const char* walk_ways[] = {"slowly", "quickly", "left", "right", "forward", "backward"};

/// Six walks that differ by speed and turn, and their texts by a word, in the form of HumanML3D.
inline void write_walks(const std::string& set) {
  std::vector<std::string> ids;
  for (int i = 0; i < 6; ++i) {
    const std::string id = "00000" + std::to_string(i);
    add_walk(set, id, 60, "guoh3d", ml::humanml3d_form,
             {.steps_per_second = 0.8 + 0.3 * (i % 3), .turn = i < 3 ? 0.9 : -0.9});
    auto clip = ml::HumanMl3dFolder(set).load(id);
    clip.captions.at(0).text = std::string("a person walks ") + walk_ways[i];
    clip.captions.at(0).words = {{"person", "NOUN"}, {"walk", "VERB"}, {walk_ways[i], "ADV"}};
    ml::write_humanml3d_clip(set, clip);
    ids.push_back(id);
  }
  for (const char* list : {"train", "val", "test"}) ml::write_ids(set + "/" + list + ".txt", ids);
}
